"""The native file: YAML in and out, its schema, its faults."""

from __future__ import annotations

from symofros.description.yaml.faults import placed_problems as placed_problems
from symofros.description.yaml.files import DIAGRAM as DIAGRAM
from symofros.description.yaml.files import MAX_BYTES as MAX_BYTES
from symofros.description.yaml.files import read_event as read_event
from symofros.description.yaml.files import read_yaml as read_yaml
from symofros.description.yaml.files import write_yaml as write_yaml
from symofros.description.yaml.schema import VERSION as VERSION
from symofros.description.yaml.schema import InertiaEntry as InertiaEntry
from symofros.description.yaml.schema import NativeFile as NativeFile
from symofros.description.yaml.schema import default_joint_name as default_joint_name
from symofros.description.yaml.schema import json_schema as json_schema
from symofros.description.yaml.schema_beam import BeamEntry as BeamEntry
from symofros.description.yaml.schema_section import SectionEntry as SectionEntry
from symofros.description.yaml.schema_solid import SolidEntry as SolidEntry
from symofros.description.yaml.yaml_nodes import MAX_DEPTH as MAX_DEPTH
from symofros.description.yaml.yaml_nodes import Node as Node
from symofros.description.yaml.yaml_nodes import YamlFault as YamlFault
from symofros.description.yaml.yaml_nodes import scalar_of as scalar_of
from symofros.description.yaml.yaml_output import key_text as key_text
from symofros.description.yaml.yaml_output import value_text as value_text
from symofros.description.yaml.yaml_output import yaml_text as yaml_text
from symofros.description.yaml.yaml_pieces import compose as compose
from symofros.description.yaml.yaml_pieces import compose_text as compose_text
from symofros.description.yaml.yaml_writer import event_data as event_data
