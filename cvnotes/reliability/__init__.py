"""Whether a calibration can be believed: what its RMS does not show, in sentences.

Parallel boards, pictures seen in a mirror and swapped coordinates fit a wrong camera as well as
good pictures fit the right one. What gives them away is how the boards stand to each other, how
well the closed form is determined, and from which side the boards are seen.
"""

from cvnotes.reliability.evidence import Evidence, likeness
from cvnotes.reliability.judgement import judge

__all__ = ["Evidence", "judge", "likeness"]
