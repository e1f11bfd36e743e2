#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders scenes, meshes, pictures and volumes that were damaged at random.

    tests/fuzz/mutations.py [--lucerna PROGRAM | --server PROGRAM] [--rounds 300] [--seed 0]
                            [--keep FOLDER]

Each round takes a scene, a mesh, a picture or a volume that is right, changes some of its bytes,
numbers or lines, and renders it; before the first round all are rendered as they are. Whatever the
change, the program must end within ten seconds with an exit code that is documented, and each error
must tell its place: file, line and column. What breaks this is kept, and the exit code is 1. The
same seed makes the same changes.

With `--lucerna` the program is started for each round; with `--server`, `render_server` of the same
build runs all rounds as children of one process, which is much faster under a sanitizer. It counts
seconds of processor time, so that other programs disturb it less.
"""
import argparse
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile

TESTS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CORPUS = os.path.join(TESTS, "fuzz", "corpus")
SCENES = os.path.join(os.path.dirname(TESTS), "scenes")
KNOT = os.path.join(SCENES, "first", "knot.ply")

# Leaves nothing to choose by pilot paths, which take most of the time of so small a picture.
CHOSEN = """<integer name="emitter_samples" value="1"/><integer name="reuse" value="2"/>
<integer name="specular_chain" value="1"/>"""
CAMERA = f"""<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="4"/>{CHOSEN}</integrator>
<sensor type="perspective"><film type="hdrfilm"/><transform name="to_world">
<lookat origin="1, 2, 5" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<emitter type="constant"/>
"""
MESH = CAMERA + """<shape type="{kind}"><string name="filename" value="{name}"/></shape>
</scene>"""
PICTURE = CAMERA + """<shape type="sphere"><bsdf type="diffuse">
<texture type="bitmap" name="reflectance"><string name="filename" value="{name}"/></texture>
</bsdf></shape></scene>"""

VOLUME = CAMERA.replace('"path"', '"volpath"').replace(
    CHOSEN, '<integer name="reuse" value="1"/>') + """<shape type="cube">
<medium type="heterogeneous" name="interior"><volume type="{kind}" name="sigma_t">
<string name="filename" value="{name}"/></volume></medium></shape></scene>"""

SDF_GRID = CAMERA + """<shape type="sdfgrid"><string name="filename" value="{name}"/></shape>
</scene>"""

MEASURED = CAMERA + """<shape type="sphere"><bsdf type="measured">
<string name="filename" value="{name}"/></bsdf></shape></scene>"""

VOLUMES = {"vol_fuzz": "gridvolume", "nanovdb_fuzz": "nanovdb"}

SECONDS = 10
MEMORY = 8 << 30  # address space [bytes]; a damaged file must not ask for more
EXIT_CODES = (0, 3, 5)  # success, wrong scene, file that cannot be read
SIZE = "8x8"  # of pictures, in pixels; --resolution needs a film in the scene
NUMBER = re.compile(rb"-?\d+(\.\d+)?")
NUMBERS = (b"0", b"-1", b"1", b"3", b"255", b"65536", b"2147483648", b"4294967295",
           b"9223372036854775808", b"1e-40", b"1e30", b"1e400", b"nan", b"-inf", b"0.5.5", b"")
PLACED = re.compile(r"^[^:]+:\d+:\d+: (error|warning): ")


def read(folder, name):
    with open(os.path.join(CORPUS, folder, name), "rb") as file:
        return file.read()


def seeds():
    """(name, bytes, scene or None) of what is to be damaged; no scene: it is one."""
    found = []
    for folder in ("obj_fuzz", "ply_fuzz", "serialized_fuzz", "image_fuzz", "measured_fuzz",
                   *VOLUMES):
        for name in sorted(os.listdir(os.path.join(CORPUS, folder))):
            kind = name.rsplit(".", 1)[1]
            if folder == "image_fuzz":
                scene = PICTURE.format(name=name)
            elif folder == "measured_fuzz":
                scene = MEASURED.format(name=name)
            elif folder in VOLUMES:
                scene = VOLUME.format(kind=VOLUMES[folder], name=name)
                if folder == "vol_fuzz":
                    found.append((name, read(folder, name), SDF_GRID.format(name=name)))
            else:
                scene = MESH.format(kind=kind, name=name)
            found.append((name, read(folder, name), scene))
    with open(os.path.join(TESTS, "vdb", "fog.vdb"), "rb") as file:
        found.append(("fog.vdb", file.read(), VOLUME.format(kind="openvdb", name="fog.vdb")))
    for name in ("first", "cornell-box", "furnace", "veach-mis"):
        with open(os.path.join(SCENES, name, "scene.xml"), "rb") as file:
            scene = file.read().replace(b'<integrator type="path">',
                                        b'<integrator type="path">' + CHOSEN.encode())
            found.append((name + ".xml", scene, None))
    for name in sorted(os.listdir(os.path.join(CORPUS, "scenes"))):
        found.append((name, read("scenes", name), None))
    return found


def change_bytes(data, rng):
    data = bytearray(data)
    for _ in range(rng.choice((1, 2, 8, 64))):
        data[rng.randrange(len(data))] = rng.choice((0, 1, 0x7f, 0x80, 0xff, rng.randrange(256)))
    return bytes(data)


def change_number(data, rng):
    found = list(NUMBER.finditer(data))
    if not found:
        return change_bytes(data, rng)
    at = rng.choice(found)
    return data[:at.start()] + rng.choice(NUMBERS) + data[at.end():]


def change_lines(data, rng):
    lines = data.split(b"\n")
    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    change = rng.randrange(4)
    if change == 0:
        del lines[i]
    elif change == 1:
        lines.insert(i, lines[j])
    elif change == 2:
        lines[i], lines[j] = lines[j], lines[i]
    else:
        lines[i] = lines[i] * rng.choice((2, 100))
    return b"\n".join(lines)


def cut(data, rng):
    return data[:rng.randrange(len(data))]


def repeat_part(data, rng):
    start = rng.randrange(len(data))
    part = data[start:start + rng.randrange(1, 200)]
    at = rng.randrange(len(data))
    return data[:at] + part * rng.choice((1, 2, 50)) + data[at:]


def damaged(data, rng):
    changes = (change_bytes, change_number, change_lines, cut, repeat_part)
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        if data:
            data = rng.choice(changes)(data, rng)
    return data


def limit_memory():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if not os.environ.get("ASAN_OPTIONS"):  # which reserves much more than it uses
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def path_of(program):
    """What finds the program from any folder."""
    return os.path.abspath(program) if os.sep in program else program


class Program:
    """The program, started for each run."""

    def __init__(self, program):
        self.program = path_of(program)

    def run(self, folder, arguments):
        """(exit code, or minus the signal; what it says on stderr); no code: it took too long."""
        try:
            done = subprocess.run([self.program, *arguments], cwd=folder, capture_output=True,
                                  timeout=SECONDS, preexec_fn=limit_memory, check=False)
        except subprocess.TimeoutExpired:
            return None, ""
        return done.returncode, done.stderr.decode(errors="replace")

    def close(self):
        """There is nothing to end."""


class Server:
    """The same by `render_server`."""

    def __init__(self, program):
        self.process = subprocess.Popen([path_of(program), str(SECONDS)], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        preexec_fn=limit_memory)

    def run(self, folder, arguments):
        self.process.stdin.write("\t".join((folder, *arguments)) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline().split()
        if len(answer) != 2:
            raise SystemExit("the server has ended")
        how, number = answer[0], int(answer[1])
        if how == "signal" and number in (signal.SIGXCPU, signal.SIGALRM):
            return None, ""
        with open(os.path.join(folder, "messages"), encoding="utf-8", errors="replace") as file:
            return number if how == "exit" else -number, file.read()

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def problem_of(program, folder, scene, right=False):
    """What is wrong with how the program ends, or None. `right`: it must make a picture."""
    code, said = program.run(folder, ("render", scene, "-o", "picture", "--resolution", SIZE,
                                      "--spp", "1", "--quiet", "--threads", "1"))
    if code is None:
        return f"it runs longer than {SECONDS} s"
    if code not in EXIT_CODES:
        return f"exit code {code}: {said[-2000:]}"
    if code == 0:
        return None
    if right:
        return f"it is right, but exit code {code}: {said[:300]}"
    if not said:
        return f"exit code {code} without a word"
    for line in said.splitlines():
        if re.match(r"^\S.*\berror: ", line) and not PLACED.match(line):
            return f"an error without a place: {line[:300]}"
    if not PLACED.match(said):
        return f"what it says begins without a place: {said[:300]}"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lucerna", default="lucerna", help="the program")
    parser.add_argument("--server", help="render_server, in place of the program")
    parser.add_argument("--rounds", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", default="mutations", help="folder for what breaks the program")
    arguments = parser.parse_args()
    program = Server(arguments.server) if arguments.server else Program(arguments.lucerna)
    broken = 0
    all_seeds = seeds()
    for i in range(-len(all_seeds), arguments.rounds):
        rng = random.Random(f"{arguments.seed}/{i}")
        name, data, scene = all_seeds[i] if i < 0 else rng.choice(all_seeds)
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, name), "wb") as file:
                file.write(damaged(data, rng) if i >= 0 else data)
            os.symlink(KNOT, os.path.join(folder, "knot.ply"))
            if scene:
                with open(os.path.join(folder, "scene.xml"), "w", encoding="utf-8") as file:
                    file.write(scene)
            problem = problem_of(program, folder, "scene.xml" if scene else name,
                                 right=i < 0 and not scene)
            if problem:
                broken += 1
                kept = os.path.join(arguments.keep, f"{arguments.seed}-{i}")
                shutil.copytree(folder, kept, dirs_exist_ok=True)
                print(f"{kept}/{name}: {problem}", flush=True)
    program.close()
    print(f"{arguments.rounds} rounds, {broken} broken")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
