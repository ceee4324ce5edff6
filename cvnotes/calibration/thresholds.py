"""From where on a user is told something: all such limits, each with its unit and its reason."""

# --- do the views determine the camera? Between sets that give the focal length and sets that do
# not, measured on 25 noisy sets of each family in tests/test_reliability.py.
UNDETERMINED, WEAK = 0.0023, 0.01  # second smallest over largest singular value of V
PARALLEL, FLAT = 5.0, 15.0  # degrees, largest angle between two boards
UNCERTAIN, UNKNOWN = 0.01, 0.10  # standard deviation of the focal length over its value
PIXEL_RATIO = 2.0  # of a pixel's height and width; sensors have 1, anamorphic video less than 2

# --- do the corners fit the camera?
OF_PICTURE = 0.005  # of the picture's longer side, RMS of a view: no camera explains so much
MISFIT, TIMES_TYPICAL = 0.5, 4  # px, and times the median view, from which a view is a stranger
OUTLIER, TIMES_MEDIAN = 0.5, 5  # px, and times the median corner: once in 30 million by noise
APART = 2  # times the next of its view, a corner misses its place by: a lens misses several alike
PART_ASTRAY = 1 / 8  # of a view's corners: more than these are no single ones
NEGLIGIBLE = 0.02  # px: what a lens misses below this does not matter
TOO_SMALL = 0.15  # part of the residuals by radius; 0.02 at most with a lens that fits
BY_CHANCE = 5.0  # F of the powers of the radius, from which they are no chance
MOVED = 0.0006  # RMS over the picture's size from which a camera must have changed or be another
TIED = 1e5  # times its variance if the others were known, a coefficient's is: 300 times as wide a ±
TIMES_NOISE = 1.5  # scatter between views over noise alone, from which both are told

# --- which lens, which board? The simpler one is kept while it predicts views left out within this
# of the other, and the other is not better in enough of them: the 95 % quantile of a normal
# variable, from which that of Student's t is taken.
AS_WELL, SURE = 1.10, 1.645
HOPELESS = 1.5  # a lens so many times worse than the best is not tried with another board
ALIKE_LEFT_OUT = 1.02  # times the best: models whose predictions nothing tells apart

# --- which photographs?
ROUNDS = 3  # in which photographs that do not fit are left out
FEWEST_KEPT, PART_KEPT = 4, 2 / 3  # how many must stay, and which part of all
EXCHANGED = 0.7  # RMS of a mirrored photograph over that of the photograph as it is
MISSES_MORE = 1.1  # RMS of such a photograph over that of a typical one
CORNERS_THAT_TELL = 40  # of a view: others miss their places together with these
# F of a second camera. Of one camera, 136 parts of 8 sets of photographs: 32 at most; of two that
# are nearly equal 51 (4 and 4 views), 59 (4 and 9), 76 (3 and 10) to 144.
PARTED = 45
# Variances of a coordinate that all views gain where some are read in a mirror: of 114 parts of
# honest sets 43 at most; of sets with mirrored views, whose camera is nearly its own mirror, mostly
# 65 to 160, of others 170 and more.
MIXED = 60
# Variances of a coordinate that a view loses, or gains, read in a mirror: half of them, in cameras
# that are not nearly their own mirror, 490 at least, in others 160 at most; and each that is named.
TELLS_ITS_MIRROR, MIRRORED = 300, 150
OTHER_BOARDS = (
    0.5  # of the photographs with the board asked for: so many with a larger one refuse it
)
MANY_WITHOUT_BOARD = 0.5  # of the photographs
SAME_PLACE = 0.5  # px, between two pictures of a board that did not move
