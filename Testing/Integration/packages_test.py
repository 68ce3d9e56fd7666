#!/usr/bin/env python3
"""The Debian package of the program, in a root that holds nothing but what it depends on: are its dependencies complete?

The root is made of the files of packages that are installed here, so that nothing is downloaded: the essential ones, and all that
the package's computed dependencies lead to. Testing/Validation/packages.sh does the same with apt, for all packages."""
import collections
import os
import pathlib
import re
import shutil
import subprocess
import sys

from bonetk_testing import TestCase, main, run

BUILD = pathlib.Path(os.environ["BONETK_BUILD"])
PROGRAMS = ("cpack", "dpkg-deb", "dpkg-query", "dpkg-shlibdeps", "ldconfig")
MERGED = ("bin", "lib", "lib64", "sbin")  # links into /usr

Installed = collections.namedtuple("Installed", "essential depends provides")


def names(relations):
    """Lists of alternatives: "a (>= 1), b | c:any" to [[a], [b, c]]."""
    return [[re.match(r"[a-z0-9+.-]+", one.strip())[0] for one in relation.split("|")]
            for relation in relations.split(",") if relation.strip()]


def installed():
    form = "${Package}\t${Essential}\t${Depends}, ${Pre-Depends}\t${Provides}\t${db:Status-Abbrev}\n"
    packages = {}
    for line in run("dpkg-query", "-W", "-f", form)[1].splitlines():
        name, essential, depends, provides, status = line.split("\t")
        if status.startswith("ii"):
            packages[name] = Installed(essential == "yes", names(depends), [one[0] for one in names(provides)])
    return packages


def closure(relations, packages):
    """The packages that relations and the essential packages lead to."""
    providers = {virtual: name for name, package in packages.items() for virtual in package.provides}
    todo = [[name] for name, package in packages.items() if package.essential] + relations
    found = set()
    while todo:
        alternatives = todo.pop()
        name = next((providers.get(one, one) if one not in packages else one for one in alternatives
                     if one in packages or one in providers), None)
        assert name, f"{' | '.join(alternatives)} is not installed here"
        if name not in found:
            found.add(name)
            todo += packages[name].depends
    return found


def fill(root, packages):
    """Links or copies the packages' files."""
    for name in MERGED:
        (root / "usr" / name).mkdir(parents=True)
        (root / name).symlink_to(f"usr/{name}")
    for path in sorted(set(run("dpkg-query", "-L", *sorted(packages))[1].splitlines())):
        source = pathlib.Path(path)
        if not path.startswith("/") or not os.path.lexists(source) or path.startswith("/usr/share/doc/"):
            continue
        target = root / path[1:]
        if source.is_dir() and not source.is_symlink():
            target.mkdir(parents=True, exist_ok=True)
        elif not os.path.lexists(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            try:
                os.link(source, target, follow_symlinks=False)
            except OSError:
                shutil.copy2(source, target, follow_symlinks=False)
    # What the packages' own scripts do when they are installed: links to the alternatives that are there.
    chosen = {str(link): os.readlink(link) for link in pathlib.Path("/etc/alternatives").iterdir() if link.is_symlink()}
    chosen = {link: target for link, target in chosen.items() if (root / target[1:]).exists()}
    for link in pathlib.Path("/usr/lib").glob("*-linux-gnu/*.so*"):
        if link.is_symlink() and os.readlink(link) in chosen:
            chosen[str(link)] = os.readlink(link)
    for link, target in chosen.items():
        (root / link[1:]).parent.mkdir(parents=True, exist_ok=True)
        if not os.path.lexists(root / link[1:]):
            (root / link[1:]).symlink_to(target)


class Packages(TestCase):
    def test_program_in_a_clean_root(self):
        code, out, err = run("cpack", "--config", BUILD / "CPackConfig.cmake", "-G", "DEB", "-B", "packages", "-D",
                             "CPACK_COMPONENTS_ALL=program", "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip")
        self.assertEqual(code, 0, out + err)
        (package,) = pathlib.Path("packages").glob("bonetk_*.deb")
        depends = names(run("dpkg-deb", "-f", package, "Depends")[1].strip())
        self.assertTrue(any(name.startswith("libinsighttoolkit") for (name, *_) in depends), depends)
        self.assertIn(["fonts-dejavu-core"], depends)

        root = pathlib.Path("root")
        needed = closure(depends, installed())
        fill(root, needed)
        self.assertNotIn("cmake", needed)
        subprocess.run(["dpkg-deb", "-x", package, root], check=True)
        (root / "tmp").mkdir(exist_ok=True)
        (root / "dev").mkdir(exist_ok=True)
        os.mknod(root / "dev/null", 0o020666, os.makedev(1, 3))
        subprocess.run(["ldconfig", "-r", root], check=True)

        within = ("chroot", root, "/usr/bin/env", "-i", "PATH=/usr/bin:/bin", "HOME=/tmp", "sh", "-euc")
        code, out, err = run(*within, "bonetk --version && cd /tmp && bonetk phantom --spacing 4 -o ct.nii.gz --labels l.nii.gz && "
                             "bonetk build ct.nii.gz --labels l.nii.gz --tetrahedra 2000 -o femur && "
                             "bonetk info femur/model.hierarchy.json")
        self.assertEqual(code, 0, out + err)
        self.assertIn("hierarchy", out)
        self.assertGreater((root / "tmp/femur/slices.png").stat().st_size, 10000)
        # Without a library it would have been seen.
        library = next((root / "usr/lib").glob("*-linux-gnu/libcairo.so.2"))
        library.unlink()
        code, _, err = run(*within, "bonetk --version")
        self.assertNotEqual(code, 0)
        self.assertIn("libcairo", err)


if __name__ == "__main__":
    missing = [program for program in PROGRAMS if not shutil.which(program)]
    if os.geteuid() != 0 or missing:
        print(f"skipped: this needs to be root, and {', '.join(PROGRAMS)}")
        sys.exit(77)
    main()
