"""Makes the WGSL that Tint translates from SPIR-V readable and callable."""
import re


def function_names(spirv_text):
    """Maps Tint's names of functions to the names in GLSL; overloads keep their types.

    spirv_text: the disassembly, in which "tsr_table(u1;" is a function.
    """
    signatures = re.findall(r'OpName %\S+ "(\w+)\(([^"]*)"', spirv_text)
    overloaded = {name for name, _ in signatures
                  if sum(other == name for other, _ in signatures) > 1}
    names = {}
    for name, types in signatures:
        mangled = re.sub(r'\W', '_', f'{name}({types}')
        short = f'{name}_{re.sub(r"[^0-9a-z]", "", types)}' if name in overloaded else name
        names[mangled] = short if name != 'main' else 'main'
    return names


def with_builtins_as_parameters(text):
    """Passes built-in values to main_1().

    Tint copies them to private variables, which WGSL takes for values that differ between the
    invocations of a group, so that no loop over them may have a barrier.
    """
    copied = re.findall(r'^  (gl_\w+) = (gl_\w+_param);\n', text, re.M)
    inputs = [name for name, _ in copied]
    if not inputs:
        return text
    for name, parameter in copied:
        text = text.replace(f'  {name} = {parameter};\n', '')
        kind = re.search(rf'^var<private> {name} : ([^;]+);\n\n?', text, re.M)
        text = text.replace(kind.group(0), '')
        text = re.sub(r'\bfn main_1\((.*?)\)', rf'fn main_1(\1, {name} : {kind.group(1)})', text)
        text = re.sub(r'^  main_1\((.*?)\);', rf'  main_1(\1, {parameter});', text, flags=re.M)
    return text.replace('main_1(, ', 'main_1(')


def readable(text, spirv_text):
    """The WGSL with the names that the GLSL source has."""
    names = function_names(spirv_text)
    text = re.sub(r'\b\w+\b', lambda word: names.get(word.group(0), word.group(0)), text)
    text = re.sub(r'^ +/\* @offset\(\d+\) \*/\n', '', text, flags=re.M)
    return with_builtins_as_parameters(text)


def callable_by_value(text, function, parameters):
    """Adds `function` with parameters by value; Tint's, which takes pointers, becomes tsr_...().

    parameters: the names and GLSL types, such as [('uv', 'vec2')].
    """
    inner = function.replace('tessera_', 'tsr_by_pointer_')
    text = re.sub(rf'\b{function}\b', inner, text)
    declared = ', '.join(f'{name} : {kind}<f32>' for name, kind in parameters)
    copies = ''.join(f'  var {name}_copy = {name};\n' for name, _ in parameters)
    passed = ', '.join(f'&{name}_copy' for name, _ in parameters)
    return (f'{text.rstrip()}\n\nfn {function}({declared}) -> vec4<f32> {{\n{copies}'
            f'  return {inner}({passed});\n}}\n')
