"""The private glass catalogue of a CODE V file: indices at a few wavelengths.

PRV
PWL 656.27 587.56 486.13            wavelengths in nanometres
'glass1' 1.6127 1.6160 1.6240       a name and the index at each
END
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from render.model.lens import Dispersion, Glass
from render.optics.dispersion.formulas import index_and_abbe
from render.optics.lens_files.drafts import check_glass
from render.optics.lens_files.lens_text import LensText

_LONGEST_NM = 1e5  # a hundred micrometres: no glass is transparent there
_POWERS = np.array([0.0, -2.0, -4.0, 2.0])


class PrivateGlasses:
    """Takes the commands between PRV and END."""

    def __init__(self, text: LensText) -> None:
        self._text = text
        self._is_open = False
        self._wavelengths_nm: list[float] = []
        self._glasses: dict[str, Glass] = {}

    def takes(self, line: int, command: str, words: Sequence[str]) -> bool:
        """Take a command if it belongs to the catalogue.

        Raises:
            InputError: the catalogue is not as it must be.
        """
        if command == "PRV":
            self._is_open = True
        elif not self._is_open:
            return False
        elif command == "END":
            self._is_open = False
        elif command == "PWL":
            self._wavelengths_nm = [self._text.number(word, "wavelength (PWL)", line, at_least=100) for word in words]
        else:
            self._add(line, command.strip("'\""), words)
        return True

    def find(self, name: str) -> Glass | None:
        """The glass of that name in the file's own catalogue."""
        return self._glasses.get(name.upper())

    def _add(self, line: int, name: str, words: Sequence[str]) -> None:
        wavelengths = np.array(self._wavelengths_nm)
        if len(words) != len(wavelengths) or len(np.unique(wavelengths)) != len(wavelengths) or not words:
            expected = f"expected one index for each of the {len(wavelengths)} wavelengths (PWL), got {len(words)}"
            raise self._text.error(f"glass {name}: {expected}", line)
        if wavelengths.max() > _LONGEST_NM:
            raise self._text.error(f"wavelengths (PWL) must be at most {_LONGEST_NM:g} nm", line)
        indices = np.array([self._text.number(word, f"index of glass {name}", line, at_least=1) for word in words])
        self._glasses[name.upper()] = check_glass(self._text, _fit(name, wavelengths, indices), line, "")


def _fit(name: str, wavelengths_nm: np.ndarray, indices: np.ndarray) -> Glass:
    """The glass through some indices: n = A + B/L² + C/L⁴ + D·L², as many terms as there are indices, by least squares.

    One or two indices do not tell how the dispersion bends: then it is that of a glass of this index and Abbe number.
    """
    powers = _POWERS[: len(indices)]
    coefficients = np.linalg.lstsq((wavelengths_nm[:, None] / 1000) ** powers, indices, rcond=None)[0]
    pairs = zip(coefficients.tolist(), powers.tolist(), strict=True)
    dispersion = Dispersion("cauchy", tuple(number for pair in pairs for number in pair))
    index, abbe = index_and_abbe(dispersion)
    return Glass(index, abbe, name=name, dispersion=dispersion if len(indices) > 2 else None)
