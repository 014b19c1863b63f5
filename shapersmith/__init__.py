"""Input shapers for flexible machines whose actuators are not ideal.

The packages `design`, `schemas` and `service` belong to it. `import shapersmith` raises an
`ImportError` that names the clash where one of these names stands for another module.
"""

from importlib.metadata import version

from shapersmith.name_clash import import_own_packages

__all__ = ["__version__"]

import_own_packages()

__version__ = version("shapersmith")
