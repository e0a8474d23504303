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


def write_variant(case, path, scanner, length_m=None, faults=None):
    """Writes an experiment like one that is shipped, and its rig beside it.
    scanner: what is other about each scanner of the rig file. length_m: of the way. faults: from
    the names of the scanners to the simulator's section "faults"."""
    source = of_case(case)
    experiment = yaml.safe_load(job_runner.read_text(source))
    rig = yaml.safe_load(job_runner.read_text(source.parent / experiment["rig"]))
    for one in rig["scanners"]:
        one.update(scanner)
    experiment["building"] = str((source.parent / experiment["building"]).resolve())
    if "file" in experiment["path"]:
        experiment["path"]["file"] = str((source.parent / experiment["path"]["file"]).resolve())
    experiment["rig"] = f"{path.stem}_rig.yaml"
    if length_m is not None:
        experiment["path"]["length_m"] = length_m
    if faults is not None:
        experiment["faults"] = faults([one["name"] for one in rig["scanners"]])
    path.parent.mkdir(parents=True, exist_ok=True)
    path.with_name(experiment["rig"]).write_text(yaml.safe_dump(rig), encoding="utf-8")
    path.write_text(yaml.safe_dump(experiment), encoding="utf-8")


def checksum(experiment):
    """A number that changes when anything changes that the simulation depends on."""
    text = repr(sorted(read(experiment).items()))
    return hashlib.sha256(text.encode()).hexdigest()
