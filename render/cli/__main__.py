"""``python -m render.cli`` is `pullfocus`."""

import sys

from render.cli.main import main

sys.exit(main())
