"""What engines are asked about: models, states, frames."""
