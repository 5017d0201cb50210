# Pullfocus. The two commands of a new user are `make serve` and `make test`; both first install what is missing.
# Each target is a script of scripts/, which can be run alone and takes arguments: scripts/test tests/render -k pinhole

.DEFAULT_GOAL := help
.PHONY: help setup serve test fuzz check docs bench schema lock clean

help:    ## say what there is
	@sed -n 's/^\([a-z]*\): *## /make \1\t/p' Makefile | expand -t 16

setup:   ## install what is missing: system libraries, .venv, the page
	@scripts/setup test

serve:   ## show the demo shot in the browser
	@scripts/serve

test:    ## run every test
	@scripts/test

fuzz:    ## search for failing examples with fresh seeds: make fuzz MINUTES=60
	@scripts/fuzz $(MINUTES)

check:   ## linters, formatters, type checkers, import contracts, dead code
	@scripts/check

docs:    ## build the documentation site into build/docs
	@scripts/docs

bench:   ## measure the engines: quality and seconds
	@scripts/bench

schema:  ## write what derives from the declared settings: the USD schema, the OpenAPI document and contract, the page's tables
	@scripts/environment
	@.venv/bin/python -m usd_schemas.generate
	@.venv/bin/python -m service.http.openapi >web/openapi.json
	@.venv/bin/python -m service.http.page_settings >web/src/model/settings.gen.ts
	@.venv/bin/python -m service.http.client_models >service/client/models.py
	@scripts/web install
	@scripts/node npm --prefix web run --silent types
	@.venv/bin/python -m service.http.contract

lock:    ## write the lock files anew from pyproject.toml
	@scripts/lock

clean:   ## remove everything that the other targets made
	rm -rf .venv .cache .mypy_cache .ruff_cache .pytest_cache .hypothesis build dist *.egg-info web/node_modules service/static
