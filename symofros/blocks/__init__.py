"""The library of blocks, by the categories of the paper's section 6."""

from symofros.blocks.controllers import JointPD as JointPD
from symofros.blocks.dynamics import ForwardDynamics as ForwardDynamics
from symofros.blocks.dynamics import InverseDynamics as InverseDynamics
from symofros.blocks.graphics import ExtremityPlot as ExtremityPlot
from symofros.blocks.graphics import Scope as Scope
from symofros.blocks.graphics import StatePlot as StatePlot
from symofros.blocks.graphics import Store as Store
from symofros.blocks.live_plot import LivePlot as LivePlot
from symofros.blocks.middleware import ZenohPublisher as ZenohPublisher
from symofros.blocks.middleware import ZenohSubscriber as ZenohSubscriber
from symofros.blocks.network import UdpReceiver as UdpReceiver
from symofros.blocks.network import UdpTransmitter as UdpTransmitter
