"""`python -m rodimpact` is the command `rodimpact`."""

from .cli import main

raise SystemExit(main())
