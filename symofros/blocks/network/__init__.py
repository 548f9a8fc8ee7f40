"""Network (section 6.2 of the paper): signals to and from other programs, by UDP and by Zenoh."""

from symofros.blocks.network.udp import UdpReceiver as UdpReceiver
from symofros.blocks.network.udp import UdpTransmitter as UdpTransmitter
from symofros.blocks.network.zenoh import ZenohPublisher as ZenohPublisher
from symofros.blocks.network.zenoh import ZenohSubscriber as ZenohSubscriber
