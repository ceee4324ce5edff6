"""Which tests hold the rows of the catalogue of bad input and faults.

A row has its number, what it is about, and its tests as ``file::test``, both without ``test_``.
Rows 1 to 18 are held by `test_catalogue.py` itself.
"""

HERE = {
    1: "NaN",
    2: "infinity",
    3: "numbers near the largest",
    4: "empty arrays",
    5: "points as columns",
    6: "a column too few or too many",
    7: "points without partners",
    8: "flattened points, further axes",
    9: "what is no array of numbers",
    10: "None",
    11: "what fails while becoming an array",
    12: "lists, other orders of memory and of bytes",
    13: "read-only input",
    14: "whole numbers",
    15: "masks and long doubles",
    16: "sizes",
    17: "numbers of distortion coefficients",
    18: "misspelt keywords",
}

ELSEWHERE = {
    # Projective geometry and rotations
    19: (
        "a last coordinate of zero",
        "projective::only_an_exact_zero_is_at_infinity_and_the_other_rows_do_not_notice",
    ),
    20: (
        "the zero vector",
        "projective::the_origin_is_a_point_but_the_zero_vector_is_not",
        "incidence::unusable_input_is_refused_in_words",
    ),
    21: (
        "any factor",
        "projective::any_factor_stands_for_the_same_point",
        "incidence::factors_do_not_matter_however_large",
    ),
    22: ("equal points joined", "incidence::what_coincides_up_to_a_factor_is_found_out"),
    23: ("parallel lines", "incidence::parallel_lines_meet_at_infinity_in_their_direction"),
    24: ("equal lines", "incidence::what_coincides_up_to_a_factor_is_found_out"),
    25: (
        "rotations by nothing, little, a half turn and many turns",
        "rigid::axis_and_angle_survive_the_way_through_a_matrix_at_every_angle",
        "rigid::many_turns_are_still_a_rotation",
    ),
    26: ("reflections", "rigid::what_is_no_rotation_is_refused_in_words"),
    27: (
        "no rotations",
        "rigid::what_is_no_rotation_is_refused_in_words",
        "rigid::where_no_rotation_is_nearest_none_is_given",
    ),
    28: ("rotations but for rounding", "rigid::a_rotation_off_by_rounding_is_accepted"),
    29: ("points behind the camera", "camera::what_is_not_before_the_camera_has_no_image"),
    30: (
        "no intrinsic matrix",
        "camera::what_is_no_intrinsic_matrix_is_refused_naming_the_entry",
    ),
    31: (
        "a negative focal length",
        "camera::what_is_no_intrinsic_matrix_is_refused_naming_the_entry",
    ),
    32: (
        "an intrinsic matrix of another scale",
        "camera::what_is_no_intrinsic_matrix_is_refused_naming_the_entry",
    ),
    33: ("points far away", "camera::points_a_million_kilometres_away_keep_their_digits"),
    34: (
        "points beyond the fold",
        "camera::what_the_lens_does_not_reach_has_no_image",
        "lens::beyond_the_fold_a_point_has_no_image",
    ),
    35: (
        "projection matrices of any scale and sign",
        "camera::a_projection_matrix_of_any_scale_and_sign_falls_into_its_factors",
    ),
    36: (
        "projection matrices of no finite camera",
        "camera::a_matrix_of_no_finite_camera_is_not_decomposed",
        "camera::a_matrix_of_too_low_rank_has_no_centre",
    ),
    37: (
        "targets that leave P open",
        "resection::degenerate_targets_are_named",
        "resection::one_point_off_the_plane_is_not_enough",
    ),
    38: (
        "targets far from their origin",
        "resection::coordinates_a_hundred_kilometres_away_cost_nothing_with_the_normalisation",
    ),
    39: (
        "rays that do not meet in front",
        "stereo::what_cannot_be_there_is_nan_and_leaves_the_others_alone",
        "stereo::what_cannot_be_triangulated_is_refused_in_words",
    ),
    # Distortion and warping
    40: (
        "no distortion",
        "lens::a_perfect_lens_moves_nothing_not_even_by_rounding",
        "warp::a_perfect_lens_leaves_the_picture_alone_bit_for_bit",
    ),
    41: ("r = 0", "lens::the_centre_stays_where_it_is_without_dividing_by_zero"),
    42: (
        "the inverse within the fold",
        "lens::undistorting_gives_back_what_was_distorted_to_1e_12_up_to_99_percent_of_the_fold",
        "radial::the_inverse_is_right_for_wild_lenses_up_to_99_percent_of_the_fold",
    ),
    43: (
        "points that the lens shows nowhere",
        "lens::a_point_that_the_lens_shows_nowhere_is_nan_and_its_neighbours_are_not",
    ),
    44: (
        "a fold inside of the picture",
        "camera::a_lens_that_folds_inside_the_picture_is_found_out",
        "warp::a_lens_that_folds_inside_the_picture_gets_a_warning_and_no_garbage",
        "reliability::other_doubts_are_said_and_the_result_is_believed",
    ),
    45: (
        "coefficients of no lens",
        "lens::coefficients_that_no_lens_has_end_in_numbers_or_nan_not_in_a_hang",
    ),
    46: (
        "NaN among coefficients, no focal length",
        "lens::unusable_coefficients_are_refused_in_words",
        "camera::what_is_no_intrinsic_matrix_is_refused_naming_the_entry",
    ),
    47: ("warps by no homography", "warp::what_is_no_homography_is_refused_in_words"),
    48: (
        "a vanishing line inside of the picture",
        "warp::a_vanishing_line_inside_the_picture_is_no_accident",
    ),
    49: (
        "pictures of impossible size",
        "warp::impossible_sizes_are_refused_before_anything_is_allocated",
        "stereo::impossible_sizes_are_refused_before_anything_is_allocated",
    ),
    50: ("what is no picture", "warp::what_is_no_picture_is_refused_in_words"),
    51: (
        "pixels of any type",
        "warp::whole_numbers_are_rounded_to_the_nearest_and_never_wrapped",
        "warp::what_is_no_picture_is_refused_in_words",
    ),
    52: (
        "identity and whole shifts",
        "warp::the_identity_gives_the_picture_back_bit_for_bit",
        "warp::a_shift_by_whole_pixels_moves_them_bit_for_bit_and_fills_the_rest",
    ),
    53: ("pictures of one pixel or row", "warp::the_smallest_pictures_are_warped_too"),
    54: ("no baseline", "stereo::a_baseline_of_zero_is_refused"),
    55: ("forward motion", "stereo::one_camera_behind_the_other_is_refused"),
    56: (
        "left and right exchanged",
        "stereo::left_and_right_exchanged_is_said_but_rows_stay_equal_and_pictures_upright",
    ),
    57: ("a vertical rig", "stereo::cameras_one_above_the_other_share_their_columns"),
    58: ("no rotation between cameras", "camera::what_is_no_pose_or_lens_is_refused"),
    # Homography and Zhang
    59: ("fewer than 4 points", "homography::points_that_fix_no_homography_are_refused_in_words"),
    60: (
        "three of four on a line",
        "homography::points_that_fix_no_homography_are_refused_in_words",
        "homography::the_4_point_solutions_take_four_points_of_which_no_three_are_collinear",
    ),
    61: ("all on a line", "homography::points_that_fix_no_homography_are_refused_in_words"),
    62: ("duplicates", "homography::points_that_fix_no_homography_are_refused_in_words"),
    63: ("on a line but for rounding", "homography::collinear_up_to_rounding_is_collinear"),
    64: (
        "unusual homographies",
        "homography::unusual_homographies_are_found_not_refused",
        "homography::dlt_needs_no_h9",
    ),
    65: (
        "20 000 points",
        "homography::many_points_need_no_square_of_their_number",
    ),
    66: (
        "similar data",
        "homography::moving_and_scaling_the_data_moves_and_scales_the_answer",
    ),
    67: (
        "points on the vanishing line, singular H",
        "warp::a_single_pixel_at_infinity_is_nan_and_its_neighbours_are_not",
        "warp::what_is_no_homography_is_refused_in_words",
        "homography::a_singular_start_is_refused",
    ),
    68: (
        "H of any scale",
        "projective::the_factor_of_H_does_not_matter",
        "warp::homographies_of_any_scale_and_unit_are_no_degenerate_ones",
    ),
    69: (
        "too few views",
        "zhang::views_that_do_not_determine_the_camera_are_refused_in_words",
        "zhang::the_6_unknown_system_on_two_views_is_refused_not_answered",
    ),
    70: (
        "identical homographies",
        "zhang::views_that_do_not_determine_the_camera_are_refused_in_words",
    ),
    71: (
        "parallel boards",
        "zhang::views_that_do_not_determine_the_camera_are_refused_in_words",
        "reliability::sets_that_leave_the_focal_length_open_are_not_believed_though_they_fit",
    ),
    72: (
        "boards parallel to the picture",
        "zhang::views_that_do_not_determine_the_camera_are_refused_in_words",
        "reliability::sets_that_leave_the_focal_length_open_are_not_believed_though_they_fit",
    ),
    73: ("B not positive definite", "zhang::a_B_that_is_not_positive_definite_is_no_camera"),
    74: ("scales and signs of H", "zhang::the_scale_of_a_homography_gives_it_no_weight"),
    75: (
        "one bad homography",
        "zhang::a_singular_homography_is_named_by_its_index",
        "catalogue::the_first_nan_is_shown_its_place",
    ),
    76: (
        "sign and scale of one H",
        "zhang::extrinsics_are_the_poses_whatever_the_scale_and_sign_of_H",
    ),
    # Calibration
    77: (
        "one or two views",
        "calibration::what_cannot_be_calibrated_is_refused_in_words",
        "calibration::warnings_point_to_whoever_called_calibrate",
    ),
    78: (
        "one view copied",
        "calibration::what_cannot_be_calibrated_is_refused_in_words",
        "reliability::one_view_again_and_again_is_one_view",
    ),
    79: (
        "all boards parallel to the picture",
        "reliability::sets_that_leave_the_focal_length_open_are_not_believed_though_they_fit",
    ),
    80: (
        "hardly any tilt",
        "reliability::sets_that_leave_the_focal_length_open_are_not_believed_though_they_fit",
    ),
    81: ("little tilt", "reliability::small_tilts_are_believed_with_a_warning"),
    82: (
        "parallel tilted boards",
        "reliability::sets_that_leave_the_focal_length_open_are_not_believed_though_they_fit",
    ),
    83: ("noise, random corners", "calibration::what_should_not_be_believed_says_so"),
    84: ("one outlier", "calibration::what_should_not_be_believed_says_so"),
    85: ("one bad view", "calibration::what_should_not_be_believed_says_so"),
    86: ("rows and columns exchanged", "calibration::what_should_not_be_believed_says_so"),
    87: ("oblong squares", "calibration::what_should_not_be_believed_says_so"),
    88: ("(v, u) for (u, v)", "calibration::what_should_not_be_believed_says_so"),
    89: ("mirrored pictures or labels", "calibration::what_should_not_be_believed_says_so"),
    90: (
        "labels from the other end",
        "calibration::boards_numbered_from_the_other_end_do_not_matter",
    ),
    91: ("a wrong size", "calibration::corners_outside_of_the_picture_are_said"),
    92: ("two resolutions", "calibration::what_should_not_be_believed_says_so"),
    93: ("a zoom that moved", "calibration::what_should_not_be_believed_says_so"),
    94: ("portrait and landscape", "calibration::what_should_not_be_believed_says_so"),
    95: ("NaN among corners", "correspondences::what_does_not_fit_together_is_refused_by_name"),
    96: (
        "equal or collinear corners",
        "calibration::what_cannot_be_calibrated_is_refused_in_words",
        "calibration::a_view_that_shows_no_plane_is_named",
    ),
    97: ("a board not flat", "correspondences::what_does_not_fit_together_is_refused_by_name"),
    98: (
        "units and origin of the board",
        "calibration::the_unit_of_the_board_does_not_matter",
        "calibration::the_origin_of_the_board_does_not_matter",
    ),
    99: ("an origin far away", "calibration::the_origin_of_the_board_does_not_matter"),
    100: (
        "exact data",
        "calibration::exact_corners_give_back_the_camera_and_the_poses",
        "calibration::exact_data_have_finite_error_bars_of_nothing",
    ),
    101: (
        "partial boards",
        "calibration::views_that_show_parts_of_the_board_give_the_same_camera",
    ),
    102: ("unusual cameras", "calibration::unusual_cameras_are_believed"),
    103: (
        "the limit of iterations",
        "optimise::what_does_not_converge_says_so",
        "reliability::doubts_that_the_error_bars_do_not_cover_make_it_unreliable",
    ),
    104: (
        "singular normal equations",
        "refine::parameters_that_the_views_say_nothing_about_are_refused",
        "optimise::a_parameter_that_changes_nothing_is_refused",
    ),
    # Photographs, files, the command
    105: ("no pictures", "photos::each_bad_file_has_its_reason_and_no_good_one_is_lost"),
    106: ("damaged pictures", "photos::each_bad_file_has_its_reason_and_no_good_one_is_lost"),
    107: (
        "all sorts of pictures",
        "photos::lossless_formats_give_their_pixels",
        "photos::alpha_is_dropped_palettes_and_cmyk_are_converted",
        "photos::16_bit_is_kept_and_its_grey_uses_the_range_that_is_there",
    ),
    108: (
        "several pictures in a file",
        "photos::of_several_pictures_the_first_is_read_and_that_is_said",
    ),
    109: (
        "EXIF rotations, mixed",
        "photos::portrait_and_landscape_of_one_sensor_are_calibrated_together",
    ),
    110: (
        "EXIF rotations",
        "photos::whatever_the_exif_rotation_pixels_stay_in_the_sensors_frame",
        "cli::an_exif_rotation_is_pointed_out",
    ),
    111: ("bombs", "photos::a_bomb_is_refused_from_its_header_quickly"),
    112: (
        "very large photographs",
        "photos::a_file_too_large_for_any_photograph_is_not_loaded",
        "photos::photographs_are_opened_one_at_a_time",
    ),
    113: (
        "pipes, links, folders, clutter",
        "photos::pipes_links_and_folders_never_block",
        "photos::an_unreadable_file_is_said",
    ),
    114: (
        "all sorts of names",
        "photos::any_name_works_and_is_printed_on_one_line",
        "cli::any_locale_any_name_and_no_home_give_the_same_camera",
    ),
    115: ("empty or missing folders", "cli::a_missing_or_empty_folder_is_said_in_one_line"),
    116: (
        "impossible or wrong boards",
        "cli::wrong_usage_is_one_line_and_exit_code_2",
        "cli::a_board_that_was_counted_wrongly_is_not_found",
    ),
    117: (
        "usage",
        "cli::wrong_usage_is_one_line_and_exit_code_2",
        "cli::help_reads_well",
        "cli::the_version_is_told",
    ),
    118: (
        "where results cannot be written",
        "cli::results_that_cannot_be_written_are_one_line_and_exit_code_1",
        "files::a_real_full_disk_is_reported",
        "files::a_read_only_file_or_a_file_for_a_folder_is_said",
    ),
    119: (
        "interruptions",
        "cli::an_interruption_leaves_the_old_result_whole_and_nothing_else",
        "files::an_interrupted_write_leaves_the_old_file_and_no_other",
    ),
    120: ("locales", "cli::any_locale_any_name_and_no_home_give_the_same_camera"),
    121: ("warnings on good data", "resection::good_data_cause_no_warnings"),
    122: (
        "Windows",
        "exercises_sandbox::without_fork_the_sentences_are_the_same",
        "exercises_sandbox::without_fork_an_endless_loop_in_python_is_stopped",
    ),
    # Files of results
    123: (
        "damaged files",
        "files::hostile_json_is_refused_with_its_position",
        "files::a_wrong_value_is_refused_by_its_key",
        "files::a_wrong_calibration_is_refused_by_its_key",
        "files::a_missing_key_is_named",
    ),
    124: ("deep, long or large files", "files::hostile_json_is_refused_with_its_position"),
    125: (
        "files that would do something",
        "files::a_python_tag_executes_nothing",
        "files::a_billion_laughs_are_refused_at_once",
        "files::xml_is_not_taken_for_yaml",
    ),
    # Exercises, explorations, notebooks
    126: (
        "student code that raises",
        "exercises_sandbox::a_misbehaving_function_gets_an_exact_sentence",
    ),
    127: (
        "student code that hangs",
        "exercises_sandbox::what_would_take_the_notebook_along_ends_in_a_sentence",
    ),
    128: (
        "student code that crashes",
        "exercises_sandbox::what_would_take_the_notebook_along_ends_in_a_sentence",
    ),
    129: (
        "answers of any kind, and cheats",
        "exercises_sandbox::a_misbehaving_function_gets_an_exact_sentence",
        "exercises_sandbox::a_patched_comparison_helps_nobody",
        "exercises_sandbox::nothing_that_gives_the_answer_away_is_at_hand_while_the_function_runs",
    ),
    130: (
        "right answers in odd clothes",
        "exercises_sandbox::a_right_answer_in_odd_clothes_passes",
    ),
    131: (
        "state left behind",
        "exercises_sandbox::state_that_a_function_leaves_behind_stays_in_its_process",
        "exercises_sandbox::children_of_a_function_end_with_it",
    ),
    132: (
        "sliders at their ends",
        "explore::each_slider_may_stand_at_zero",
        "explore::all_sliders_may_stand_at_their_ends_in_every_combination",
        "explore::a_dozen_random_settings_each_give_a_picture_of_the_same_size",
        "explore::no_figure_is_left_open",
    ),
    133: (
        "notebooks run again, in any order",
        "wheel::a_notebook_runs_and_then_backwards",
    ),
    134: ("random seeds", "layers::nothing_in_the_package_prints_or_seeds_globally"),
    135: (
        "other platforms and versions",
        "environment::the_oldest_versions_tested_are_the_oldest_promised",
        "theorems::undistorting_undoes_distorting_inside_the_largest_radius",
    ),
}
