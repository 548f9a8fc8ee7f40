"""What engines are asked about: trees for kinds of joints, hostile trees, files."""
