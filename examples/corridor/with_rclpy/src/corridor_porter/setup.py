from glob import glob

from setuptools import setup

NAME = "corridor_porter"

setup(
    name=NAME,
    version="1.0.0",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + NAME]),
        ("share/" + NAME, ["package.xml"]),
        ("share/" + NAME + "/config", glob("config/*.yaml")),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="The robot's team",
    maintainer_email="robot@example.org",
    description="Goes through a corridor, and asks whoever is in the way to step aside.",
    license="Apache-2.0",
    entry_points={"console_scripts": ["porter = corridor_porter.main:main"]},
)
