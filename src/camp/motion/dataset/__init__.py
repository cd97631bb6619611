"""The expert's data set: what is asked for, generated, recorded, validated and reported."""
