"""What a study rests on and shows: reference numbers, findings with their bounds, charts."""
