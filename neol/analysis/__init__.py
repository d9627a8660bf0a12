"""From records to the paper's tables and figures: reads, computes and prints; runs nothing."""
