"""What an experiment of the simulator depends on."""

import hashlib

import yaml

import job_runner

FOLDER = job_runner.ROOT / "configs" / "experiments"


def of_case(case):
    """The experiment of that name, in the folder or in its folder robustness."""
    for folder in (FOLDER / "robustness", FOLDER):
        if (folder / f"{case}.yaml").exists():
            return folder / f"{case}.yaml"
    raise job_runner.InputError(f"no case {case} in {FOLDER}")


def read(experiment):
    """Text of everything the simulation depends on, by the names that the experiment has for it:
    the experiment, its building, its rig and its path; of a mesh a checksum."""
    text = job_runner.read_text(experiment)
    try:
        parts = yaml.safe_load(text)
        names = [parts["building"], parts["rig"]]
        names += [path["file"] for path in [parts.get("path")]
                  if isinstance(path, dict) and "file" in path]
    except (yaml.YAMLError, KeyError, TypeError) as error:
        reason = str(error).replace("\n", " ")
        raise job_runner.InputError(
            f"{experiment}: not an experiment with building and rig: {reason}") from error
    return {experiment.name: text, **{name: read_part(experiment.parent / name)
                                      for name in names}}


def read_part(path):
    if path.suffix == ".ply":
        return "sha256 " + hashlib.sha256(path.read_bytes()).hexdigest()
    return job_runner.read_text(path)


def checksum(experiment):
    """A number that changes when anything changes that the simulation depends on."""
    text = repr(sorted(read(experiment).items()))
    return hashlib.sha256(text.encode()).hexdigest()
