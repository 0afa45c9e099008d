"""Projects of library users: the examples of docs/examples, built outside the tree against what accept.install installed."""

import pathlib

from acceptance import run

SHARED = "-Dpilotage_SHARED_LIBS=ON"


class Toolchain:
    """What the build under test was made with: generator, compiler, compiler launcher and sanitizers ("" for none)."""

    def __init__(self, generator, cxx, launcher, sanitizers):
        self.options = ["-G", generator, f"-DCMAKE_CXX_COMPILER={cxx}", f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}",
                        "-DCMAKE_BUILD_TYPE=Release"]
        if sanitizers:
            self.options.append(f"-DCMAKE_CXX_FLAGS=-fsanitize={sanitizers}")


def has_shared(prefix):
    """Whether shared libraries are installed there (PILOTAGE_SHARED_LIBS)."""
    return any(pathlib.Path(prefix).rglob("libpilotage_onboard.so"))


def build_example(toolchain, source, name, prefix, build, *options):
    """Builds docs/examples/<name> against the installation in `prefix`. Returns the program."""
    run("cmake", "-S", source / "docs/examples" / name, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}",
        *toolchain.options, *options)
    run("cmake", "--build", build)
    return build / f"{name}_example"
