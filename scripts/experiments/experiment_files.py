"""What an experiment of the simulator depends on."""

import hashlib
import pathlib

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


def load(case):
    """The experiment of that name with absolute paths of its files, as a dictionary."""
    source = of_case(case)
    experiment = yaml.safe_load(job_runner.read_text(source))
    for holder, key in ((experiment, "building"), (experiment, "rig"),
                        (experiment["path"], "file")):
        if key in holder:
            holder[key] = str((source.parent / holder[key]).resolve())
    return experiment


def load_rig(path):
    """A rig file, as a dictionary."""
    return yaml.safe_load(job_runner.read_text(pathlib.Path(path)))


def write(path, experiment, rig):
    """Writes an experiment (a dictionary with absolute paths), and its rig beside it."""
    rig_file = path.with_name(f"{path.stem}_rig.yaml")
    path.parent.mkdir(parents=True, exist_ok=True)
    rig_file.write_text(yaml.safe_dump(rig), encoding="utf-8")
    path.write_text(yaml.safe_dump({**experiment, "rig": rig_file.name}), encoding="utf-8")


def write_variant(case, path, scanner, length_m=None, faults=None):
    """Writes an experiment like one that is shipped, and its rig beside it.
    scanner: what is other about each scanner of the rig file. length_m: of the way. faults: from
    the names of the scanners to the simulator's section "faults"."""
    experiment = load(case)
    rig = load_rig(experiment["rig"])
    for one in rig["scanners"]:
        one.update(scanner)
    if length_m is not None:
        experiment["path"]["length_m"] = length_m
    if faults is not None:
        experiment["faults"] = faults([one["name"] for one in rig["scanners"]])
    write(path, experiment, rig)


def checksum(experiment):
    """A number that changes when anything changes that the simulation depends on."""
    text = repr(sorted(read(experiment).items()))
    return hashlib.sha256(text.encode()).hexdigest()
