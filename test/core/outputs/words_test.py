#!/usr/bin/python3
"""What the report's page says of a map's worth, and of numbers that are held and not measured."""

import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

from viewer_install import find_program

SCRIPT = pathlib.Path(__file__).with_name("words.mjs")
sys.argv[1:] = []


def report(verdict, symptoms, warnings):
    summary = {"consistency": {"verdict": verdict, "symptoms": symptoms}, "warnings": warnings,
               "variance_factor": 1.0, "points": 100, "points_used": 90, "segments": 5,
               "residual_rms_m": 0.02, "duration_s": 12.0, "real_time_factor": 9.0}
    if verdict != "consistent":
        summary["cause"] = {"name": "the rig was lost", "evidence": "it jumps",
                            "next_step": "move slower"}
    return {"title": "a map", "summary": summary,
            "planes": [{"sigma_distance_m": 0.00123, "sigma_angle_deg": 0.1}]}


def arc(radius, turn):
    """A cylinder that is seen over a turn of its normal, from below and above."""
    places = [(radius * math.sin(a), radius * math.cos(a))
              for a in (turn * (i / 200 - 0.5) for i in range(201))]
    return {"type": "cylinder", "radius": radius, "normal": [0, 1, 0],
            "outline": [[x, y, 0] for x, y in places] + [[x, y, 1] for x, y in places[::-1]]}


def calibration(unobserved):
    def parameter(name, value, sigma, prior_sigma, observed=True):
        return {"name": name, "value": value, "sigma": sigma, "prior_sigma": prior_sigma,
                "observed": observed}

    return {"unobserved": unobserved, "scanners": [
        {"name": "top", "parameters": [parameter("roll_deg", 0, 0, 0),
                                       parameter("range_m", -0.0098, 0.00012, 0.01)]},
        {"name": "left", "parameters": [parameter("roll_deg", 0.98765, 0.0049, 1),
                                        parameter("z_m", 0.0031, 0.0071, 0.01, not unobserved),
                                        parameter("time_s", 0.00199, 0.000021, 0.002)]}]}


class Words(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        symptoms = [{"start_s": 3, "end_s": 9, "what": ["beams pass", "it jumps (from 4 to 5 s)"]},
                    {"start_s": 20, "end_s": 22, "what": ["surfaces are doubled"]}]
        case = {"reports": [report("consistent", [], []),
                            report("doubtful", symptoms, [f"warning {i}" for i in range(40)]),
                            report("contradictory", symptoms, [])],
                "calibrations": [calibration([]), calibration(["height of scanner left"])],
                "cylinders": [arc(17.0, 0.06), arc(2.0, math.pi), arc(3.0, 2 * math.pi)]}
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump(case, file)
            file.flush()
            run = subprocess.run([find_program("node"), str(SCRIPT), file.name], check=True,
                                 capture_output=True, text=True)
        cls.found = json.loads(run.stdout)

    def test_cause_comes_first_and_symptoms_after_it_by_interval(self):
        text = self.found["tops"][1]["verdict"]
        words = ["Likeliest cause the rig was lost", "What speaks for it it jumps",
                 "What to do move slower", "Doubtful from 3 to 9 s", "beams pass",
                 "it jumps (from 4 to 5 s)", "Doubtful from 20 to 22 s", "surfaces are doubled",
                 "40 warnings", "Warning 39."]
        places = [text.find(word) for word in words]
        self.assertNotIn(-1, places, text)
        self.assertEqual(places, sorted(places), text)

    def test_a_band_warns_of_maps_that_are_not_consistent(self):
        self.assertEqual([top["band"] for top in self.found["tops"]],
                         [None, "The map is doubtful: lengths and areas may be wrong",
                          "The map contradicts the scans it was made from: do not use it"])

    def test_precision_is_stated_of_consistent_maps_alone(self):
        stated = [["1.23 mm" in top["figures"], "1.64 mm" in top["figures"]]
                  for top in self.found["tops"]]
        self.assertEqual(stated, [[True, True], [False, False], [False, False]])
        self.assertIn("not stated", self.found["tops"][2]["figures"])
        self.assertNotIn("Likeliest", self.found["tops"][0]["verdict"])

    def test_what_is_held_is_not_measured(self):
        self.assertEqual(self.found["held"], ["90.0000° (held, not measured)",
                                              "2.0000 m (held, not measured)"])
        self.assertEqual(self.found["measured"], ["90.0000° ± 0.0057°", "2.0000 m ± 1.0 mm"])

    def test_rig_with_standard_deviations_and_what_is_open(self):
        shown, partly = self.found["rigs"]
        for words in ("top held", "-9.80 mm ± 0.12 mm", "left 0.9877° ± 0.0049°",
                      "1.990 ms ± 0.021 ms", "This recording shows all of it."):
            self.assertIn(words, shown)
        self.assertIn("3.1 mm ± 7.1 mm", shown)
        self.assertNotIn("open", shown)
        self.assertIn("open: 3.1 mm ± 7.1 mm", partly)
        self.assertIn("This recording does not show height of scanner left: ", partly)

    def test_bow_of_an_arc(self):
        for found, true in zip(self.found["bows"], [17 * (1 - math.cos(0.03)), 2.0, 6.0]):
            self.assertAlmostEqual(found, true, delta=1e-3 * true)


if __name__ == "__main__":
    unittest.main()
