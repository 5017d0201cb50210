"""The private glass catalogue of a CODE V file: indices at a few wavelengths, or coefficients of a formula.

PRV
PWL 656.27 587.56 486.13            wavelengths in nanometres
'glass1' 1.6127 1.6160 1.6240       a name and the index at each
'glass2' LAU 2.27 -0.0101 0.0106 0.000208 -7.65e-6 4.92e-7
END

LAU is Laurent's series, n² = A0 + A1·L² + A2/L² + A3/L⁴ + A4/L⁶ + A5/L⁸ with the wavelength L in micrometres: that of Schott's
older catalogues.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from render.model.lens import Dispersion, Glass
from render.optics.dispersion.formulas import index_and_abbe
from render.optics.lens_files.drafts import check_glass
from render.optics.lens_files.lens_text import LensText

_LONGEST_NM = 1e5  # a hundred micrometres: no glass is transparent there
_LAURENT = (0, 2, -2, -4, -6, -8, -10, -12)  # powers of the wavelength
_FORMULAS = ("GMS", "GML", "SLM", "SEL", "CAU", "HAR", "HER", "BUC")  # other formulas of private glasses
_POWERS = np.array([0.0, -2.0, -4.0, 2.0, -6.0, -8.0])
_MANY = 7  # indices, from which on all terms are fitted; fewer, rounded as they are, would make them swing


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
        formula = words[0].upper() if words else ""
        if formula in _FORMULAS:
            raise self._text.error(f"glass {name}: the formula {formula} is not supported, only indices and LAU", line)
        if formula == "LAU":
            self._glasses[name.upper()] = self._by_laurent(line, name, words[1:])
            return
        wavelengths = np.array(self._wavelengths_nm)
        if len(words) != len(wavelengths) or len(np.unique(wavelengths)) != len(wavelengths) or not words:
            expected = f"expected one index for each of the {len(wavelengths)} wavelengths (PWL), got {len(words)}"
            raise self._text.error(f"glass {name}: {expected}", line)
        if wavelengths.max() > _LONGEST_NM:
            raise self._text.error(f"wavelengths (PWL) must be at most {_LONGEST_NM:g} nm", line)
        indices = np.array([self._text.number(word, f"index of glass {name}", line, at_least=1) for word in words])
        self._glasses[name.upper()] = check_glass(self._text, fit_indices(name, wavelengths, indices), line, "")

    def _by_laurent(self, line: int, name: str, words: Sequence[str]) -> Glass:
        if not 2 <= len(words) <= len(_LAURENT):
            raise self._text.error(f"glass {name}: LAU takes 2 to {len(_LAURENT)} coefficients, got {len(words)}", line)
        numbers = [self._text.number(word, f"coefficient of glass {name}", line) for word in words]
        pairs = zip(numbers, _LAURENT, strict=False)
        dispersion = Dispersion("powers", tuple(float(number) for pair in pairs for number in pair))
        with np.errstate(all="ignore"):
            index, abbe = index_and_abbe(dispersion)
        return check_glass(self._text, Glass(index, abbe, name=name, dispersion=dispersion), line, "")


def fit_indices(name: str, wavelengths_nm: np.ndarray, indices: np.ndarray) -> Glass:
    """The glass through some indices: n = A + B/L² + C/L⁴ + D·L² + E/L⁶ + F/L⁸, or fewer terms, by least squares.

    One or two indices do not tell how the dispersion bends: then it is that of a glass of this index and Abbe number.

    Args:
        name: of the glass.
        wavelengths_nm: of the indices.
        indices: at these wavelengths.
    """
    powers = _POWERS[: len(_POWERS) if len(indices) >= _MANY else min(len(indices), 4)]
    coefficients = np.linalg.lstsq((wavelengths_nm[:, None] / 1000) ** powers, indices, rcond=None)[0]
    pairs = zip(coefficients.tolist(), powers.tolist(), strict=True)
    dispersion = Dispersion("cauchy", tuple(number for pair in pairs for number in pair))
    index, abbe = index_and_abbe(dispersion)
    return Glass(index, abbe, name=name, dispersion=dispersion if len(indices) > 2 else None)
