"""Graphics (section 6.2 of the paper): what is kept, plotted and viewed of a run."""

from symofros.blocks.graphics.live_plot import LivePlot as LivePlot
from symofros.blocks.graphics.recorders import ExtremityPlot as ExtremityPlot
from symofros.blocks.graphics.recorders import Scope as Scope
from symofros.blocks.graphics.recorders import StatePlot as StatePlot
from symofros.blocks.graphics.recorders import Store as Store
from symofros.blocks.graphics.view import View3D as View3D
