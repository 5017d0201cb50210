"""Templates of Open Job Description: their form, the names that they can hold, and what a farm makes of them."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from unicodedata import category

import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from service.jobs.openjd import FarmJob, PathParameter, check_literal, make_template, refer, required_parameters

FOLDER = Path("/farm/job")
SHOT = FOLDER / "shot.usda"
needs_openjd = pytest.mark.skipif(find_spec("openjd") is None, reason="openjd-cli is not installed")


def make_job(**changes):
    given = {"name": "shot", "shot": SHOT, "folder": FOLDER / "out", "image_name": "a.####.exr", "frames": [3, 1, 2]}
    return FarmJob(**given | changes)


def definitions(template):
    return {parameter["name"]: parameter for parameter in template["parameterDefinitions"]}


def run_action(template):
    return template["steps"][0]["script"]["actions"]["onRun"]


def decode(template):
    """The template as the reference implementation reads it; it raises where the template is not valid."""
    from openjd.model import decode_job_template

    return decode_job_template(template=template)


def resolve(template, values):
    """Values of the job's parameters as a farm has them for a template in `FOLDER`."""
    from openjd.model import preprocess_job_parameters

    found = preprocess_job_parameters(
        job_template=decode(template), job_parameter_values=values, job_template_dir=FOLDER, current_working_dir=FOLDER
    )
    return {name: parameter.value for name, parameter in found.items()}


def test_a_task_for_each_frame_in_one_step():
    template = make_template(make_job(width_px=64, rays=9, options=["--film=portra_400"], timeout_s=60), FOLDER)
    (step,) = template["steps"]
    assert step["parameterSpace"] == {"taskParameterDefinitions": [{"name": "Frame", "type": "INT", "range": "1-3"}]}
    assert run_action(template) == {
        "command": "pullfocus",
        "args": [
            "record",
            "{{Param.Shot}}",
            "{{Param.OutputFolder}}/{{Param.ImageName}}",
            "--film=portra_400",
            "--imageWidth={{Param.Width}}",
            "--rays={{Param.Rays}}",
            "--frames={{Task.Param.Frame}}",
        ],
        "timeout": 60,
    }


def test_parameters_say_what_is_read_and_what_is_written():
    found = definitions(make_template(make_job(width_px=64), FOLDER))
    flows = {
        name: (each["objectType"], each["dataFlow"], each["default"]) for name, each in found.items() if name[0] in "SO"
    }
    assert flows == {
        "Shot": ("FILE", "IN", "shot.usda"),
        "ShotFolder": ("DIRECTORY", "IN", "."),
        "OutputFolder": ("DIRECTORY", "OUT", "out"),
    }
    assert found["Width"]["default"] == 64
    assert "Rays" not in found


def test_products_have_their_names_in_the_shot():
    template = make_template(make_job(image_name=None), FOLDER)
    assert "ImageName" not in definitions(template)
    assert run_action(template)["args"][2] == "{{Param.OutputFolder}}"


def test_what_lies_elsewhere_is_given_at_submission():
    lens = PathParameter("LensFile", Path("/lenses/a.dat"), "IN", "Lens.")
    job = make_job(files=[lens], options=[f"--lens={refer('LensFile')}"])
    assert required_parameters(job, FOLDER) == [lens]
    assert "default" not in definitions(make_template(job, FOLDER))["LensFile"]


@needs_openjd
def test_a_farm_resolves_paths_to_the_same_files():
    job = make_job(folder=Path("/elsewhere/out"))
    template = make_template(job, FOLDER)
    with pytest.raises(ValueError, match="OutputFolder"):
        resolve(template, {})
    given = {each.name: str(each.path) for each in required_parameters(job, FOLDER)}
    values = resolve(template, given)
    assert (values["Shot"], values["ShotFolder"], values["OutputFolder"]) == (str(SHOT), str(FOLDER), "/elsewhere/out")


@needs_openjd
@given(st.sets(st.integers(-(10**6), 10**6), min_size=1, max_size=40))
def test_a_farm_reads_the_frames_that_were_asked_for(frames):
    from openjd.model import IntRangeExpr

    (step,) = make_template(make_job(frames=list(frames)), FOLDER)["steps"]
    (task,) = step["parameterSpace"]["taskParameterDefinitions"]
    assert set(IntRangeExpr.from_str(task["range"])) == frames


@needs_openjd
@given(st.text(min_size=1, max_size=140).filter(lambda name: "/" not in name and name not in (".", "..")))
def test_any_name_is_taken_as_it_is_or_refused(name):
    job = make_job(name="shot", shot=FOLDER / name, image_name=name, folder=FOLDER / name)
    if any(category(character) == "Cc" for character in name):
        with pytest.raises(SettingsError, match="control character") as refused:
            make_template(job, FOLDER)
        assert "\n" not in refused.value.detail
        return
    template = make_template(job, FOLDER)
    values = resolve(template, {})
    assert (values["Shot"], values["OutputFolder"]) == (str(FOLDER / name), str(FOLDER / name))
    assert values["ImageName"] == name


@needs_openjd
@given(st.text(st.sampled_from("{} a\"'\\$`;\n\u00e9\u202e"), max_size=12))
def test_any_option_is_passed_on_as_it_is_or_refused(text):
    from openjd.model import SymbolTable

    if any(part in text for part in ("{{", "}}", "\n")):
        with pytest.raises(SettingsError, match="--look has"):
            check_literal("--look", text)
        return
    option = f"--look={check_literal('--look', text)}"
    script = decode(make_template(make_job(options=[option]), FOLDER)).steps[0].script
    assert script.actions.onRun.args[3].resolve(symtab=SymbolTable()) == option


@pytest.mark.parametrize("name", ["a{{b", "a}}b", "{{Param.Shot}}", "a\nb", "a\x7fb", "a\udcffb"])
def test_names_of_jobs_that_no_template_holds(name):
    with pytest.raises(SettingsError) as refused:
        make_template(make_job(name=name), FOLDER)
    assert refused.value.code == "bad_template_text"
    assert refused.value.detail.isprintable()


@needs_openjd
def test_a_long_name_of_a_job_is_cut():
    assert decode(make_template(make_job(name="n" * 200), FOLDER)).name == "n" * 128


def test_a_path_longer_than_a_parameter_is_refused():
    with pytest.raises(SettingsError, match="1024 characters"):
        make_template(make_job(shot=FOLDER / "/".join(["n" * 200] * 6)), FOLDER)
