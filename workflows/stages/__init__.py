"""The stages of a run, one script each: ``python -m workflows.stages.install CASE -o DIR``."""

from workflows.environment import prepare

prepare()  # each stage is also a script: before numpy and numba are imported
