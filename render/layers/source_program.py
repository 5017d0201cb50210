"""Programs that pyrender draws with, of our own sources."""

from __future__ import annotations

from pathlib import Path

from render.errors import RefusedProgramError
from render.gl.compat import GL, pyrender
from render.gl.shaders import SHADER_DIR, load_source
from render.model.refused_programs import REFUSED


class SourceProgram(pyrender.shader_program.ShaderProgram):  # type: ignore[misc]
    """pyrender's shader program with sources from our loader (includes, defines); uniform locations are cached."""

    def __init__(
        self, fragment: str, defines: dict[str, object], maps: tuple[tuple[str, int], ...], functions: str = ""
    ) -> None:
        """Compile a program; ``maps`` are the names of the material's samplers, and their texture units, and ``functions`` those
        of its network.

        Raises:
            RefusedProgramError: the driver refuses the functions, which are in `REFUSED` from then on.
        """
        self._functions = functions
        super().__init__(str(SHADER_DIR / "layers/surface.vert"), str(SHADER_DIR / fragment), defines=defines)
        self.maps = maps
        self._locations: dict[str, int] = {}
        try:
            self._add_to_context()
        except RuntimeError as problem:
            if not functions:
                raise
            reason = " ".join(str(problem.args[0] if problem.args else problem).split())[:300]
            REFUSED.add(functions, reason)
            raise RefusedProgramError(f"the program of a network of nodes is refused: {reason}") from problem

    def _load(self, shader_filename: str) -> str:
        source = load_source(Path(shader_filename).relative_to(SHADER_DIR).as_posix(), self.defines)
        return source.replace("\n#pragma surface_graph\n", f"\n{self._functions}\n", 1)

    def _add_to_context(self) -> None:
        super()._add_to_context()
        GL.glUseProgram(self._program_id)
        for name, unit in self.maps:
            GL.glUniform1i(self.location(name), unit)

    def location(self, name: str) -> int:
        """Uniform location, -1 where the program has no such uniform (which GL ignores)."""
        if name not in self._locations:
            self._locations[name] = GL.glGetUniformLocation(self._program_id, name)
        return self._locations[name]
