"""The suite of manoeuvres: what a hull does without a controller, beside trials and limits."""
