#!/usr/bin/env python3
"""Translates the shaders to HLSL, MSL and WGSL, which `tessera shaders --dialect` writes.

    python3 decoder_glsl/dialects/translate.py --tool build/bin/tessera --node-modules DIR
    python3 decoder_glsl/dialects/translate.py --tool build/bin/tessera --check

The first command writes decoder_glsl/dialects/translations.zst, which the library contains: each
program for each set of macros that changes it. The command needs glslangValidator, spirv-val,
spirv-dis, spirv-as, spirv-cross, zstd, node, and in DIR the package @babylonjs/core
(tests/shaders/run.sh installs it). The second command needs none of these: it fails if the tool
writes a shader that was not translated from the GLSL as it is now.
"""
import argparse
import hashlib
import itertools
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import wgsl_names  # noqa: E402

HERE = pathlib.Path(__file__).parent
ARCHIVE = HERE / 'translations.zst'
ENDINGS = {'hlsl': 'hlsl', 'msl': 'metal', 'wgsl': 'wgsl'}
MACROS = ['TSR_OUTPUT_HALF', 'TSR_PREDICTED_TILES', 'TESSERA_RESIDENT_CACHE',
          'TESSERA_HARDWARE_FILTER', 'TESSERA_COVERAGE_ONLY']
# The viewer's programs for spheres, which engines draw as any mesh.
LEFT_OUT = ['render.comp.glsl', 'render.frag.glsl', 'render.vert.glsl']
# Translators keep only what a program calls: so this one calls what sample.glsl offers.
PROBE = '''
layout(location = 0) in vec3 tsr_probe_a;
layout(location = 1) in vec3 tsr_probe_b;
layout(location = 2) in vec3 tsr_probe_c;
layout(location = 3) in vec2 tsr_probe_d;
layout(location = 0) out vec4 tsr_probe_colour;
void main() {
    tsr_probe_colour =
        tessera_sample(tsr_probe_a, tsr_probe_b) +
        tessera_sample_surface(tsr_probe_d, tsr_probe_a, tsr_probe_b, tsr_probe_c, tsr_probe_d);
}
'''
ENTRY_POINTS = {
    'tessera_sample': [('from_centre', 'vec3'), ('direction', 'vec3')],
    'tessera_sample_surface': [('uv', 'vec2'), ('normal', 'vec3'), ('tangent', 'vec3'),
                               ('direction', 'vec3'), ('footprint', 'vec2')]}


def run(*command):
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if result.returncode:
        sys.exit(f'{" ".join(map(str, command))}\n{result.stdout}{result.stderr}')
    return result.stdout


def with_block_names(binary):
    """Names the variables of blocks that GLSL declares without one: tessera_work of TesseraWork."""
    text = run('spirv-dis', binary)
    blocks = r'^ *(%\S+) = OpVariable %_ptr_(?:Uniform|StorageBuffer)_(Tessera\w+) '
    for variable, block in re.findall(blocks, text, re.M):
        name = re.sub(r'(?<=[a-z])(?=[A-Z])', '_', block).lower()
        text = text.replace(f'OpName {variable} ""', f'OpName {variable} "{name}"')
    assembly = binary.with_suffix('.asm')
    assembly.write_text(text)
    run('spirv-as', '--target-env', 'vulkan1.1', '-o', binary, assembly)


class Program:
    """A shader and the macros that it is translated with."""

    def __init__(self, name, macros, source):
        self.name, self.macros, self.source = name, macros, source
        self.stem = '-'.join((name.removesuffix('.glsl'), *macros))
        self.is_library = name == 'sample.glsl'
        self.stage = 'frag' if self.is_library else name.split('.')[1]

    def head(self):
        """The first line of the translations. It names the source by the hash of its code."""
        code = [re.sub(r'\s+', ' ', line.split('//')[0]).strip()
                for line in self.source.splitlines() if not line.startswith('#line')]
        digest = hashlib.sha256('\n'.join(filter(None, code)).encode()).hexdigest()[:16]
        return f'// {" ".join((self.name, *self.macros))}, source {digest}, by translate.py\n'

    def glsl(self):
        return '#version 450\n' + self.source + PROBE if self.is_library else self.source


def written(tool, dialect, macros):
    """The shaders that the tool writes, by name."""
    with tempfile.TemporaryDirectory() as folder:
        defines = itertools.chain.from_iterable(('-D', macro) for macro in macros)
        run(tool, 'shaders', '-o', folder, '--dialect', dialect, *defines)
        return {file.name: file.read_text() for file in pathlib.Path(folder).iterdir()}


def sources(tool, macros):
    found = written(tool, 'vulkan', ('TSR_TRANSLATED', *macros))
    return {name: text for name, text in found.items() if name not in LEFT_OUT}


def programs(tool):
    found = []
    for name, text in sorted(sources(tool, []).items()):
        used = [macro for macro in MACROS if re.search(rf'\b{macro}\b', re.sub('//.*', '', text))]
        if name == 'layered_mesh.frag.glsl':
            used.remove('TESSERA_RESIDENT_CACHE')  # layers are plain textures
        for count in range(len(used) + 1):
            found += [(name, macros) for macros in itertools.combinations(used, count)]
    by_macros = {macros: sources(tool, macros) for macros in {macros for _, macros in found}}
    return [Program(name, macros, by_macros[macros][name]) for name, macros in found]


def library_of(text, dialect):
    """Removes the probe's entry point from the translation of sample.glsl."""
    ends = {'hlsl': 'void frag_main()', 'msl': 'fragment main0_out', 'wgsl': 'fn main_1('}
    text = text[:text.index(ends[dialect])]
    text = re.sub(r'struct (main0_|SPIRV_Cross_)(in|out|Input|Output)\n\{[^}]*\};\n\n', '', text)
    text = re.sub(r'^.*\btsr_probe_\w+.*\n+', '', text, flags=re.M)
    if dialect == 'wgsl':
        for function, parameters in ENTRY_POINTS.items():
            text = wgsl_names.callable_by_value(text, function, parameters)
    return text.rstrip() + '\n'


def translated(all_programs, modules, folder):
    """Yields the dialect, the program and the text of each translation."""
    for program in all_programs:
        glsl = folder / f'{program.stem}.{program.stage}'
        glsl.write_text(program.glsl())
        binary = folder / f'{program.stem}.spv'
        run('glslangValidator', '-V', '--target-env', 'vulkan1.1', '-o', binary, glsl)
        with_block_names(binary)
        run('spirv-val', '--target-env', 'vulkan1.1', binary)
    run('node', HERE / 'tint.cjs', modules, folder)
    for program in all_programs:
        binary = folder / f'{program.stem}.spv'
        texts = {'hlsl': run('spirv-cross', binary, '--hlsl', '--shader-model', '60'),
                 'msl': run('spirv-cross', binary, '--msl', '--msl-version', '20100',
                            '--msl-decoration-binding'),
                 'wgsl': wgsl_names.readable((folder / f'{program.stem}.wgsl').read_text(),
                                             run('spirv-dis', binary))}
        for dialect, text in texts.items():
            yield dialect, program, library_of(text, dialect) if program.is_library else text


def write_archive(all_programs, modules):
    """Writes for each shader a key, such as "hlsl texels.comp.glsl TSR_OUTPUT_HALF", and its text,
    each with a zero byte behind it."""
    with tempfile.TemporaryDirectory() as folder:
        found = translated(all_programs, modules, pathlib.Path(folder))
        records = {' '.join((dialect, program.name, *program.macros)): program.head() + text
                   for dialect, program, text in found}
        joined = pathlib.Path(folder) / 'joined'
        joined.write_text(''.join(f'{key}\0{records[key]}\0' for key in sorted(records)))
        run('zstd', '-19', '-q', '-f', '-o', ARCHIVE, joined)


def complaints(tool, all_programs):
    """What is wrong with the translations that the tool writes."""
    found = []
    for dialect, ending in ENDINGS.items():
        for macros in sorted({program.macros for program in all_programs}):
            heads = {name: text.splitlines(True)[0]
                     for name, text in written(tool, dialect, macros).items()}
            for program in all_programs:
                name = program.name.replace('glsl', ending)
                if program.macros == macros and heads.get(name) != program.head():
                    found.append(f'{name} {" ".join(macros)} is missing or older than its shader')
    return found


def main():
    options = argparse.ArgumentParser()
    options.add_argument('--tool', required=True, help='path of the tool tessera')
    options.add_argument('--node-modules', type=pathlib.Path)
    options.add_argument('--check', action='store_true')
    chosen = options.parse_args()
    found = programs(chosen.tool)
    if chosen.check:
        if wrong := complaints(chosen.tool, found):
            sys.exit('\n'.join(wrong) + '\ndecoder_glsl/DIALECTS.md says how to translate again')
        return
    if not chosen.node_modules:
        options.error('--node-modules or --check is needed')
    write_archive(found, chosen.node_modules.resolve())
    print(f'{ARCHIVE}: {len(found)} shaders in {len(ENDINGS)} dialects, '
          f'{ARCHIVE.stat().st_size} bytes. Build the tool again.')


if __name__ == '__main__':
    main()
