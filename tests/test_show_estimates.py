"""A figure of an estimate: arrows from the truth to what is predicted."""

from cvnotes.show import draw_plane_error


def test_an_arrow_leads_from_the_truth_to_the_prediction_ten_times_as_long():
    ax = draw_plane_error([[10.0, 20], [30, 5]], [[10.5, 20], [30, 4]])
    (arrows,) = ax.collections
    assert arrows.get_offsets().tolist() == [[10, 20], [30, 5]]
    assert (arrows.U.tolist(), arrows.V.tolist()) == ([5, 0], [0, -10])
    assert not arrows.get_clip_on()
    assert ax.get_title() == "(arrows × 10)"
