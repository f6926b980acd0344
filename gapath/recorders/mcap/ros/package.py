"""``gapath_msgs``: the definitions of a log's own messages as a package of ROS 2."""

from pathlib import Path

from gapath.recorders.mcap.format import definitions

PACKAGE = "gapath_msgs"
"""Name of the package, as logs have it."""

_XML = """\
<?xml version="1.0"?>
<package format="3">
  <name>{package}</name>
  <version>{version}</version>
  <description>The messages of gapath's logs</description>
  <maintainer email="nobody@example.org">whoever made it by gapath-log messages</maintainer>
  <license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""

_CMAKE = """\
cmake_minimum_required(VERSION 3.8)
project({package})
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces(${{PROJECT_NAME}}
{files})
ament_export_dependencies(rosidl_default_runtime)
ament_package()
"""


def package_files(version: str) -> dict[Path, str]:
    """Make the package's files, of the very texts that logs hold as schemas.

    Parameters
    ----------
    version : str
        The package's: gapath's, of which it takes three numbers.

    Returns
    -------
    dict of Path to str
        Place within the package -> text.
    """
    texts = {Path("msg") / f"{name}.msg": text for name, text in definitions().items()}
    listed = "".join(f'  "{path.as_posix()}"\n' for path in texts)
    numbers = ".".join(version.split(".")[:3])
    return {
        Path("package.xml"): _XML.format(package=PACKAGE, version=numbers),
        Path("CMakeLists.txt"): _CMAKE.format(package=PACKAGE, files=listed),
        **texts,
    }
