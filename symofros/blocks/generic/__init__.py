"""Generic blocks: signals, sampling."""

from symofros.blocks.generic.sampling import Hold as Hold
from symofros.blocks.generic.sampling import UnitDelay as UnitDelay
from symofros.blocks.generic.signals import Constant as Constant
from symofros.blocks.generic.signals import Gain as Gain
from symofros.blocks.generic.signals import Join as Join
from symofros.blocks.generic.signals import Pick as Pick
from symofros.blocks.generic.signals import Product as Product
from symofros.blocks.generic.signals import Sum as Sum
