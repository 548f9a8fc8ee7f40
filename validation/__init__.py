"""Do independent engines agree with the generated code, how fast are they, and where do methods fail."""

from symofros.harness import claim

claim(__name__)
