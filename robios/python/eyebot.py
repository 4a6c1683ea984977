"""The module eye under the name that some programs give it: `from eyebot import *`."""

from eye import *  # noqa: F401,F403
