"""Where packages are: in the folders that the scenario names."""

from ament_index_python.packages import PackageNotFoundError as PackageNotFoundError
from ament_index_python.packages import get_package_prefix as get_package_prefix
from ament_index_python.packages import get_package_share_directory as get_package_share_directory
from ament_index_python.packages import get_package_share_path as get_package_share_path
from ament_index_python.packages import get_packages_with_prefixes as get_packages_with_prefixes
