"""Which calibration would you trust."""

from cvnotes.calibration import calibrate
from cvnotes.tutor import Case, Exercise, Property, mistakes

EXERCISE = Exercise(
    name="which_to_trust",
    chapter=9,
    title="Which calibration would you trust?",
    task="""Four calibrations of the same camera. Which of them would you trust to 1 %?
A: RMS 0.12 px, 20 pictures, all with the board facing the camera.
B: RMS 0.35 px, 15 pictures, boards tilted by up to 40° to all sides, α_u = 812.4 ± 1.1.
C: RMS 0.09 px, 3 pictures, lens k1 k2 p1 p2 k3, α_u = 790 ± 31.
D: RMS 2.8 px, 15 pictures, tilted by up to 40°; two of them have an RMS of 7 px.""",
    stub='my_which_to_trust = ...  # "A", "B", "C" or "D"',
    hints=(
        "RMS says how well the model fits these pictures, not how well they determine it.",
        "What do boards that face the camera leave open?",
        "Look at tilt, error bars and single views before you look at RMS.",
    ),
    cases=lambda _: [Case(())],
    properties=(Property("Its pictures determine the camera, and its error bars say so."),),
    misconceptions=mistakes(
        ("small RMS of parallel boards", "Boards that all face the camera leave the focal length "
         "open: any α with the right distance fits as well, and the small RMS tells nothing of it.",
         lambda: 0.0),
        ("smallest RMS", "Many parameters always fit few pictures. ± 31 px are 4 % of α_u.",
         lambda: 2.0),
        ("bad views not looked at", "Two views spoil this one: corners badly found, or the board "
         "bent. Leave them out and calibrate again before trusting it.",
         lambda: 3.0),
    ),
    reference=lambda: 1.0,
    concepts=("m", "f", "E37"),
    answer="value",
    choices=("A", "B", "C", "D"),
    sources=(calibrate,),
)  # fmt: skip
