"""Cross-sections of beams: what material and geometry bring to them."""

from symofros.description.beams.sections.closed_forms import circle as circle
from symofros.description.beams.sections.closed_forms import ellipse as ellipse
from symofros.description.beams.sections.closed_forms import rectangle as rectangle
from symofros.description.beams.sections.closed_forms import tube as tube
from symofros.description.beams.sections.material import Material as Material
from symofros.description.beams.sections.polygons import box as box
from symofros.description.beams.sections.polygons import i_section as i_section
from symofros.description.beams.sections.polygons import l_section as l_section
from symofros.description.beams.sections.polygons import polygon as polygon
from symofros.description.beams.sections.section import Section as Section
