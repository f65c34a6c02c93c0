// A program of two shaders, and its uniforms.

class Program {
    // vertex, fragment: names of shader files of the kit, which are joined. `defines` are macros for both shaders.
    constructor(gl, kit, vertex, fragment, defines = []) {
        this.gl = gl;
        const text = parts => ['#version 300 es', ...defines.map(d => `#define ${d}`),
            'precision highp float;\nprecision highp int;\nprecision highp sampler2D;\nprecision highp sampler2DArray;',
            ...parts.map(name => kit.text(name).replace(/^#include.*$/gm, ''))].join('\n');
        this.program = gl.createProgram();
        for (const [kind, parts] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
            const shader = gl.createShader(kind);
            gl.shaderSource(shader, text(parts));
            gl.compileShader(shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
                throw Error(`${parts.at(-1)}: ${gl.getShaderInfoLog(shader)}`);
            gl.attachShader(this.program, shader);
        }
        gl.linkProgram(this.program);
        if (!gl.getProgramParameter(this.program, gl.LINK_STATUS))
            throw Error(gl.getProgramInfoLog(this.program));
        this.uniforms = new Map();
        for (let i = 0; i < gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS); ++i) {
            const {name, type} = gl.getActiveUniform(this.program, i);
            this.uniforms.set(name.replace('[0]', ''), {type, at: gl.getUniformLocation(this.program, name)});
        }
        this.units = 0;
    }

    // Makes the program current. `values` are uniforms by name, and the program ignores unknown names. The value of a
    // sampler is {texture, target}.
    use(values) {
        const {gl} = this;
        gl.useProgram(this.program);
        this.units = 0;
        for (const [name, value] of Object.entries(values)) {
            const uniform = this.uniforms.get(name);
            if (uniform)
                this.set(uniform, value);
        }
    }

    set({type, at}, value) {
        const {gl} = this;
        switch (type) {
        case gl.FLOAT: return Array.isArray(value) ? gl.uniform1fv(at, value) : gl.uniform1f(at, value);
        case gl.FLOAT_VEC2: return gl.uniform2fv(at, value);
        case gl.FLOAT_VEC3: return gl.uniform3fv(at, value);
        case gl.FLOAT_VEC4: return gl.uniform4fv(at, value);
        case gl.FLOAT_MAT4: return gl.uniformMatrix4fv(at, false, value);
        case gl.INT: return Array.isArray(value) ? gl.uniform1iv(at, value) : gl.uniform1i(at, value);
        case gl.BOOL: return gl.uniform1i(at, value ? 1 : 0);
        case gl.INT_VEC2: return gl.uniform2iv(at, value);
        case gl.INT_VEC4: return gl.uniform4iv(at, value);
        default: // a sampler
            gl.activeTexture(gl.TEXTURE0 + this.units);
            gl.bindTexture(value.target, value.texture);
            gl.uniform1i(at, this.units++);
            gl.activeTexture(gl.TEXTURE0 + 15); // bindTexture() calls elsewhere must not replace this texture
        }
    }
}
