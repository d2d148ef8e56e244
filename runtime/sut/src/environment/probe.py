"""What an interpreter says about itself: the last line that this prints is JSON.

    python -I -c PROBE [pip]

With `pip`, also the options of pip's configuration that decide what it installs.
"""

import json
import os
import site
import sys
from importlib.machinery import EXTENSION_SUFFIXES

# Of pip's options, those that say how it talks and fetches; a change of them installs nothing else.
MANNERS = frozenset(
    "cache-dir cert client-cert config-file debug default-timeout disable-pip-version-check exists-action "
    "keyring-provider log log-file no-cache-dir no-color no-input no-python-version-warning no-warn-script-location "
    "progress-bar proxy quiet require-virtualenv resume-retries retries root-user-action timeout trusted-host user "
    "verbose".split()
)


def search_path():
    """`sys.path`, with the user's own packages where they would be without `-I`."""
    path = [folder for folder in sys.path if folder]
    virtual = sys.prefix != sys.base_prefix
    if os.environ.get("PYTHONNOUSERSITE") or (virtual and sys.base_prefix not in site.PREFIXES):
        return path
    folder = site.getusersitepackages()
    if not os.path.isdir(folder):
        return path
    site.addsitedir(folder)
    own = [added for added in sys.path if added and added not in path]
    shared = site.getsitepackages()
    place = next((at for at, known in enumerate(path) if known in shared), len(path))
    return path[:place] + own + path[place:]


def text_of(*parts):
    try:
        with open(os.path.join(*parts), encoding="utf-8", errors="replace") as file:
            return file.read()
    except OSError:
        return ""


def is_hook(folder, name):
    lines = text_of(folder, name).splitlines()
    return any(line.startswith(("import ", "import\t")) and "editable" in line for line in lines)


def hooked(path):
    """The packages that are installed as editable by a hook in a `.pth` file, and their folders if known."""
    found = []
    for folder in path:
        try:
            names = sorted(os.listdir(folder))
        except OSError:
            continue
        hooks = [name for name in names if name.endswith(".pth") and is_hook(folder, name)]
        for info in names if hooks else ():
            if not info.endswith(".dist-info"):
                continue
            record = text_of(folder, info, "RECORD")
            if any(line.split(",")[0] in hooks for line in record.splitlines()):
                try:
                    url = json.loads(text_of(folder, info, "direct_url.json"))["url"]
                except (ValueError, KeyError):
                    url = ""
                found.append({"package": info[: -len(".dist-info")].split("-")[0], "url": url})
    return found


def files_of_pip():
    """Its configuration files in the order in which it reads them."""
    own = os.environ.get("PIP_CONFIG_FILE")
    if own == os.devnull:
        return []
    home, mac = os.path.expanduser("~"), sys.platform == "darwin"
    folders = (os.environ.get("XDG_CONFIG_DIRS") or "/etc/xdg").split(os.pathsep)
    shared = "/Library/Application Support" if mac else None
    user = os.path.join(home, "Library/Application Support") if mac else None
    if not (user and os.path.isdir(os.path.join(user, "pip"))):
        user = os.environ.get("XDG_CONFIG_HOME") or os.path.join(home, ".config")
    files = [os.path.join(folder, "pip", "pip.conf") for folder in folders + [shared] if folder]
    files += ["/etc/pip.conf", os.path.join(home, ".pip", "pip.conf"), os.path.join(user, "pip", "pip.conf")]
    return files + [os.path.join(sys.prefix, "pip.conf")] + ([own] if own else [])


def options_of_pip():
    """Lists of section, name and value."""
    options = []
    for file in filter(os.path.isfile, files_of_pip()):
        import configparser

        parser = configparser.RawConfigParser()
        try:
            parser.read(file)
        except (configparser.Error, UnicodeDecodeError) as error:
            options.append(["error", file, str(error)])
        for section in ("global", "install"):
            if parser.has_section(section):
                options += [[section, name.lower().replace("_", "-"), value] for name, value in parser.items(section)]
    for name, value in sorted(os.environ.items()):
        if name.startswith("PIP_"):
            options.append([":env:", name[4:].lower().replace("_", "-"), value])
    return [option for option in options if option[1] not in MANNERS]


def main():
    path = search_path()
    told = {
        "executable": sys.executable,
        "base": sys.base_prefix,
        "version": list(sys.version_info[:3]),
        "tag": "-".join([sys.version.split()[0], sys.implementation.cache_tag, sys.platform, EXTENSION_SUFFIXES[0]]),
        "path": path,
        "hooked": hooked(path),
        "pip": options_of_pip() if "pip" in sys.argv else [],
    }
    sys.stdout.write("\n" + json.dumps(told) + "\n")


main()
