#!/usr/bin/env python3
"""clang-tidy over every source of the libraries, the programs and the tests.

Most of clang-tidy's time goes into the headers of Eigen, the standard library and Catch2, so sources with the same flags are
checked together, in one generated file that includes them. Names of unnamed namespaces must not collide in it: sources
that share such a name go into different groups, and a group that does not compile is halved. A group that has passed is not
checked again until one of its sources, a header of the project or the settings change.

Usage: lint.py BUILD_FOLDER JOBS
"""
import concurrent.futures
import hashlib
import json
import pathlib
import re
import shlex
import subprocess
import sys

FOLDERS = ("libwavelet", "libbrdf", "libprobe", "renderer", "tools", "tests")
GROUP_SIZE = 16
# A definition at the left margin: the code's layout does not indent the content of namespaces.
DEFINED = re.compile(
    r"^(?:template .*>\s*)?(?:(?:struct|class|enum class|enum|using|union)\s+(\w+)|[\w:<>,&*\[\] ]*?\b(\w+)\s*(?:\(|=|\{|\[|;))")


def flags_of(command):
    """The command's definitions, and its folders of headers."""
    words = shlex.split(command)
    definitions = tuple(word for word in words if word.startswith("-D"))
    folders = [word for word in words if word.startswith("-I")]
    folders += [f"-isystem{words[i + 1]}" for i, word in enumerate(words) if word == "-isystem"]
    return definitions, folders


def local_names(source):
    """Names that the source defines in unnamed namespaces, and its macros."""
    names, inside = set(), False
    for line in source.read_text().splitlines():
        if line.startswith("namespace {"):
            inside = True
        elif line.startswith("} // namespace\n") or line == "} // namespace":
            inside = False
        elif line.startswith("#define"):
            names.add(line.split()[1].split("(")[0])
        elif inside and line[:1].isalpha():
            match = DEFINED.match(line)
            if match:
                names.add(match.group(1) or match.group(2))
        elif line.startswith(("using ", "namespace ")) and "=" in line:
            names.add(line.split()[1])
    return names


def group_sources(root, build):
    """Lists of sources with equal definitions and disjoint names. All headers can be found in all of them."""
    groups, all_folders = [], {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        source = pathlib.Path(entry["file"])
        if not source.is_relative_to(root) or source.relative_to(root).parts[0] not in FOLDERS:
            continue
        definitions, folders = flags_of(entry["command"])
        all_folders.update(dict.fromkeys(folders))
        names = local_names(source)
        for group in groups:
            if group["definitions"] == definitions and len(group["sources"]) < GROUP_SIZE and not group["names"] & names:
                break
        else:
            group = {"definitions": definitions, "sources": [], "names": set()}
            groups.append(group)
        if source not in group["sources"]:
            group["sources"].append(source)
            group["names"] |= names
    for group in groups:
        group["flags"] = ["-std=c++20", *group["definitions"], *all_folders]
    return groups


def check(sources, flags, settings, build):
    """The report of clang-tidy on a group; empty if it passes."""
    text = "".join(f'#include "{source}"\n' for source in sources)
    content = settings + " ".join(flags) + text + "".join(source.read_text() for source in sources)
    key = hashlib.sha256(content.encode()).hexdigest()[:32]
    stamp = build / "lint" / key
    if stamp.exists():
        return ""
    unit = stamp.with_suffix(".cpp")
    unit.write_text(text)
    command = ["clang-tidy", "--quiet", "--checks=-bugprone-suspicious-include", str(unit), "--", *flags, "-Wno-everything"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    unit.unlink()
    if run.returncode == 0:
        stamp.touch()
        return ""
    if len(sources) > 1 and "clang-diagnostic-error" in run.stdout:
        middle = len(sources) // 2
        return check(sources[:middle], flags, settings, build) + check(sources[middle:], flags, settings, build)
    return run.stdout


def main():
    root = pathlib.Path.cwd()
    build, jobs = pathlib.Path(sys.argv[1]).resolve(), int(sys.argv[2])
    (build / "lint").mkdir(exist_ok=True)
    headers = sorted(path for folder in FOLDERS for path in (root / folder).rglob("*.h"))
    settings = (root / ".clang-tidy").read_text() + "".join(path.read_text() for path in headers)
    groups = group_sources(root, build)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        reports = list(pool.map(lambda g: check(g["sources"], g["flags"], settings, build), groups))
    print("".join(dict.fromkeys(reports)), end="")
    print(f"lint: {sum(len(g['sources']) for g in groups)} sources in {len(groups)} groups")
    return 1 if any(reports) else 0


if __name__ == "__main__":
    sys.exit(main())
