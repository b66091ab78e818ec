//! Cases that once broke a law, by name. They are tried in every run, as `backend::regressions::name`.
//!
//! A law that fails prints the line to add here; the name says what was wrong.

use crate::checks::{closure, facets, invariance, sums};
use crate::{Case, Given, domains::Pose, domains::Shape, law::Law, sites::Sites, weights::Weights};

/// Name, law and case.
pub const CASES: &[(&str, Law, Case)] = &[
    (
        "rounding_is_not_a_facet",
        facets::positive,
        Case {
            seed: 328301,
            count: 13,
            sites: Sites::Clustered,
            weights: Weights::Mild,
            shape: Shape::LongBox,
            pose: Pose::Turned,
        },
    ),
    (
        "rounding_is_not_a_volume",
        sums::volume,
        Case {
            seed: 3894,
            count: 14,
            sites: Sites::OnSurface,
            weights: Weights::Concurrent,
            shape: Shape::TouchingInPartOfFace,
            pose: Pose::Turned,
        },
    ),
    (
        "apex_near_a_triangles_plane",
        closure::volume,
        Case {
            seed: 684303,
            count: 1,
            sites: Sites::Clustered,
            weights: Weights::None,
            shape: Shape::Sphere,
            pose: Pose::Turned,
        },
    ),
    (
        "apex_near_a_triangles_plane_in_a_knot",
        sums::boundary_area,
        Case {
            seed: 237327,
            count: 3,
            sites: Sites::TurnedLattice,
            weights: Weights::None,
            shape: Shape::Trefoil,
            pose: Pose::Plain,
        },
    ),
    (
        "apex_near_a_triangles_plane_after_a_move",
        invariance::translation,
        Case {
            seed: 598765,
            count: 1,
            sites: Sites::Clustered,
            weights: Weights::None,
            shape: Shape::Sphere,
            pose: Pose::Turned,
        },
    ),
    (
        "apex_near_a_triangles_plane_after_a_turn",
        invariance::rotation,
        Case {
            seed: 591321,
            count: 10,
            sites: Sites::OnSurface,
            weights: Weights::Strong,
            shape: Shape::Trefoil,
            pose: Pose::Plain,
        },
    ),
    (
        "a_hair_has_no_winding_number",
        sums::volume,
        Case {
            seed: 101409,
            count: 57,
            sites: Sites::Coplanar,
            weights: Weights::Concurrent,
            shape: Shape::TouchingInVertex,
            pose: Pose::Turned,
        },
    ),
];

/// Name and scene of what fuzzing found (`fuzz/`); each is held to all laws of one output and to the oracle.
pub const SCENES: &[(&str, Given)] = &[
    (
        "facet_whose_corner_slides_along_it",
        Given {
            room: None,
            positions: &[
                [0.9999999602221338, 0.5000000159111441, 1.0000000397778628],
                [1.0000000278445031, 2.784450542359096e-8, 0.5000000278445064],
                [2.784450775505931e-8, -2.7844503480700666e-8, 0.4999999482887773],
            ],
            weights: &[],
        },
    ),
    (
        "facet_with_a_cell_called_empty",
        Given {
            room: Some((Shape::Tetrahedron, Pose::Plain)),
            positions: &[[0.0, 0.25, 0.0], [0.0, 1.0, 0.75]],
            weights: &[0.0, 6.25e-11],
        },
    ),
    (
        "facet_split_by_planes_all_but_one",
        Given {
            room: Some((Shape::Plate, Pose::Plain)),
            positions: &[
                [1.4999999999999998, 2.0, 0.005000000000000005],
                [1.4999999999999998, 2.0000000000000004, 0.005000000000000006],
                [1.4999999999999998, 1.9999999999999998, 0.015000000000000005],
            ],
            weights: &[],
        },
    ),
    (
        "slab_at_the_surface_called_empty",
        Given {
            room: Some((Shape::Plate, Pose::Turned)),
            positions: &[
                [0.21212214030723425, -4.506929807310509, 12.519608637358342],
                [-0.001182445374031782, -5.374903729945636, 11.847487053600808],
                [-0.0011423244236926644, -5.368969160774518, 11.83943849602429],
            ],
            weights: &[],
        },
    ),
    (
        "slab_is_not_nothing",
        Given {
            room: Some((Shape::Plate, Pose::Turned)),
            positions: &[
                [-0.3975091330960716, -5.131558529583607, 12.03115324553618],
                [-0.3975893749967496, -5.143427667925843, 12.047250360689219],
            ],
            weights: &[],
        },
    ),
    (
        "slab_in_touching_boxes_is_not_nothing",
        Given {
            room: Some((Shape::TouchingInEdge, Pose::Plain)),
            positions: &[
                [1.9999999999998408, 2.000000000000676, 1.0342282585895646e-12],
                [1.9999999999994433, 2.0000000000005573, 0.5000000000010341],
                [5.568878691519784e-13, -5.568878691519786e-13, 0.4999999999989657],
                [2.0000000000005573, 5.568878691519785e-13, 0.5000000000005568],
            ],
            weights: &[2.249999999999999, 2.0000000000000013, 2.0, 2.000000000000001],
        },
    ),
    (
        "negative_facet_at_an_edge_of_the_surface",
        Given {
            room: Some((Shape::DoubleTorus, Pose::Turned)),
            positions: &[
                [-1.6778397634812217, -3.8221250903144637, 12.977851478882659],
                [-1.6778397634812214, -3.8221250903144637, 12.97785147888266],
                [-1.681851858515124, -4.415582007426294, 13.782707236534653],
                [-0.4889198817406109, -4.56106254515723, 12.438925739441329],
                [-1.6778397634812217, -3.8221250903144637, 12.97785147888266],
            ],
            weights: &[],
        },
    ),
    (
        "facet_along_an_edge_dropped_on_one_side",
        Given {
            room: Some((Shape::TouchingInEdge, Pose::Plain)),
            positions: &[
                [-5.306866057708248e-14, 1.3333333333328161, 0.3333333333326173],
                [1.9999999999995757, 2.000000000000597, 0.33333333333436754],
            ],
            weights: &[1.1388888888888888, 2.027777777777778],
        },
    ),
    (
        "facet_along_two_edges_dropped_on_one_side",
        Given {
            room: Some((Shape::TouchingInVertex, Pose::Turned)),
            positions: &[
                [1.3077054677875208, -4.9602305979397725, 12.77478615549542],
                [0.9053806979891825, -5.604103488661112, 14.16171170511979],
            ],
            weights: &[],
        },
    ),
    (
        "facet_along_two_edges_among_thin_cones",
        Given {
            room: Some((Shape::TouchingInVertex, Pose::Turned)),
            positions: &[
                [0.3301844265857988, -3.6352112560914973, 14.368139963579445],
                [1.1268097761140785, -3.5343793288737265, 13.204000379633767],
            ],
            weights: &[],
        },
    ),
    (
        "negative_facet_of_needles",
        Given {
            room: None,
            positions: &[
                [0.4999999999999997, 1.0, 0.5000000000000001],
                [0.7500000000000002, 0.7500000000000002, 2.7755575615628914e-16],
                [0.7499999999999999, 0.7500000000000002, 0.5000000000000002],
                [1.0000000000000004, 0.5000000000000004, 3.885780586188048e-16],
            ],
            weights: &[0.25, 0.37499999999999994, 0.12500000000000006, 0.5],
        },
    ),
    (
        "negative_facet_beside_sites_two_roundings_apart",
        Given {
            room: Some((Shape::Box, Pose::Plain)),
            positions: &[
                [-4.110379103750005e-8, 0.9999999681777078, 0.6666666388221597],
                [-4.110379103750006e-8, 0.9999999681777079, 0.6666666388221595],
                [0.33333328427396847, 0.6666666454518045, 0.9999999907184963],
                [-1.4585215035722855e-8, 0.9999999761332813, 0.3333333054888275],
                [0.6666666892074558, 0.333333346592622, 0.333333342614836],
            ],
            weights: &[],
        },
    ),
    (
        "long_box_across_its_grid",
        Given {
            room: Some((Shape::LongBox, Pose::Plain)),
            positions: &[[5.542732008068, 0.5605010631371555, -2.351663027508645]],
            weights: &[],
        },
    ),
    (
        "needle_that_may_be_nothing",
        Given {
            room: None,
            positions: &[
                [0.5000000000002783, -5e-324, 0.49999999999988065],
                [0.49999999999999994, 0.5, 0.5],
                [0.4999999999997215, 1.0, 0.5000000000001195],
                [0.4999999999997215, 1.0000000000000002, 0.5000000000001192],
            ],
            weights: &[0.25, 3.0814879110195774e-33, 0.25, 0.2500000000000002],
        },
    ),
    (
        "sites_turned_about_each_other_by_the_frame",
        Given {
            room: Some((Shape::Cavity, Pose::Turned)),
            positions: &[
                [1.2711841763688219, -7.862349149681762, 12.498427499193532],
                [1.2711841763688214, -7.862349149681761, 12.498427499193534],
            ],
            weights: &[],
        },
    ),
    (
        "negative_facet_of_feet_between_nearly_parallel_planes",
        Given {
            room: Some((Shape::Plate, Pose::Turned)),
            positions: &[
                [0.24274565202560816, -2.4771929237237176, 13.979105257408357],
                [-0.36704610517905367, -3.1255599226812882, 13.522844095892273],
                [-2.287571339260375, -4.461590235515356, 12.509517481001797],
                [-1.9826955211332138, -4.14037402062213, 12.7416723405481],
                [-1.677859823956391, -3.825092374900022, 12.98187575767092],
                [-0.45849697477393203, -2.560998507426032, 13.938665147373944],
            ],
            weights: &[
                4.500100000000004,
                2.5001,
                8.000025000000003,
                6.250100000000003,
                5.000025000000002,
                5.0001000000000015,
            ],
        },
    ),
    (
        "facets_of_two_clusters_in_a_folded_prism",
        Given {
            room: Some((Shape::FoldedCorner(8), Pose::Plain)),
            positions: &[
                [0.1775036146859239, 0.7554659114924275, 0.1788946130227508],
                [0.17734346385297936, 0.7552463695994784, 0.178829950212163],
                [0.8845766977926359, 0.006123263755284674, 0.477489379214505],
                [0.8845767271398245, 0.006123262199512039, 0.47748940138701307],
            ],
            weights: &[0.14543629408454423, 0.14546149765988287, 0.13769900335966961, 0.1376990129788186],
        },
    ),
    (
        "cell_beside_a_cluster_does_not_close",
        Given {
            room: Some((Shape::FoldedStar(8), Pose::Plain)),
            positions: &[
                [0.8641629460774817, 0.42753891554227624, 0.26468817882751655],
                [0.8641629449886816, 0.4275389206560176, 0.2646881780861944],
                [0.8641629447303049, 0.4275389214907342, 0.2646881766552983],
                [0.6016000903038174, 0.5120564018538117, 0.44392563224733533],
                [0.601600088634685, 0.512056397135666, 0.44392566206331285],
            ],
            weights: &[
                -0.10246538812163211,
                -0.10246538578317353,
                -0.10246538561379587,
                -0.07762666847362526,
                -0.07762667208307684,
            ],
        },
    ),
    (
        "closure_of_negative_facets_alone",
        Given {
            room: Some((Shape::FoldedComb(1), Pose::Plain)),
            positions: &[
                [0.776768312048377, 0.6629938770129618, -0.04690101493025322],
                [0.7607549120177654, 0.6669524014216147, -0.04215358255149071],
                [0.7824075209622875, 0.7458810979986032, -0.03109062441915874],
                [0.795895548301867, 0.654562615215496, -0.037958743493518264],
                [0.7191975523353288, 0.6801063892607844, -0.003446613327947892],
            ],
            weights: &[],
        },
    ),
    (
        "slab_of_an_empty_cell_is_boundary",
        Given {
            room: Some((Shape::FoldedStar(5), Pose::Turned)),
            positions: &[
                [0.5331359721244091, -5.397125224652563, 12.910529682989722],
                [0.5336265088050459, -5.3936068077999355, 12.91371162746677],
                [0.5338880244016261, -5.397124528621156, 12.91115642670896],
                [0.5323496120769952, -5.394506283857746, 12.911015206732879],
            ],
            weights: &[],
        },
    ),
    (
        "wedge_of_an_empty_cell_is_boundary",
        Given {
            room: Some((Shape::FoldedCorner(3), Pose::Plain)),
            positions: &[
                [0.4115305101935287, 0.6408948992303249, 0.18114374250079615],
                [0.3476837508937309, 0.7405775893855122, 0.24771533085572642],
                [0.4351707349212948, 0.6979340182389653, 0.19748724052322317],
                [0.38498689084795784, 0.6369992879795053, 0.21912646725479185],
                [0.37746185622160994, 0.7367453564679266, 0.10714648823505847],
            ],
            weights: &[],
        },
    ),
    (
        "negative_facet_that_one_side_does_not_believe",
        Given {
            room: Some((Shape::FoldedStar(6), Pose::Turned)),
            positions: &[
                [0.5667219263230255, -5.491143498185212, 12.211430355719896],
                [1.0962301512539938, -4.887703493601701, 12.71329028350791],
                [0.5603500066751851, -5.41761434487413, 13.036389923169633],
                [1.0214613471577954, -5.162123873363087, 12.475781629848472],
                [0.9701786946163979, -5.552406434670467, 12.61506372067142],
            ],
            weights: &[],
        },
    ),
    (
        "barycenter_of_a_facet_whose_areas_cancel",
        Given {
            room: Some((Shape::FoldedComb(1), Pose::Plain)),
            positions: &[
                [0.4414865068341529, 0.791610786654299, 0.09487136714577582],
                [0.6511120198865885, 0.4759176108036598, 0.4910837178984474],
                [0.01953059839879881, 0.13620166957547494, 0.40277204213733947],
                [0.01953059780327137, 0.13620167010164774, 0.40277203928635713],
                [0.01953059487750043, 0.13620167171931474, 0.40277204179083215],
            ],
            weights: &[
                0.1683046712735076,
                0.03933909171390494,
                0.2483638629485277,
                0.24836386310739594,
                0.24836386470035773,
            ],
        },
    ),
    (
        "negative_facet_of_cells_a_few_roundings_wide",
        Given {
            room: Some((Shape::Plate, Pose::Turned)),
            positions: &[
                [1.309711515303984, -4.663502139384667, 12.372358276669122],
                [0.3341162797198084, -3.0536234773212105, 13.579381321079723],
                [0.33411627971980845, -3.0536234773212105, 13.579381321079724],
                [0.3341965216204865, -3.0417543389789734, 13.563284205926683],
                [0.3341162797198084, -3.053623477321211, 13.579381321079724],
            ],
            weights: &[],
        },
    ),
    (
        "negative_facet_beside_a_cell_a_few_roundings_wide",
        Given {
            room: Some((Shape::Plate, Pose::Turned)),
            positions: &[
                [0.3341162797198084, -3.0536234773212105, 13.579381321079723],
                [0.33415640067014746, -3.0476889081500924, 13.571332763503204],
                [0.33415640067014746, -3.0476889081500915, 13.571332763503202],
                [0.3341564006701475, -3.047688908150092, 13.571332763503202],
            ],
            weights: &[],
        },
    ),
    (
        "slab_of_an_empty_cell_is_negative",
        Given {
            room: Some((Shape::FoldedStar(6), Pose::Turned)),
            positions: &[
                [0.48251460649321554, -5.403604533877042, 12.942264720323566],
                [0.491409485970846, -5.422498915457951, 12.941279129662716],
                [0.4796490823371603, -5.401325944487718, 12.93995553580931],
                [0.48605734138412243, -5.412146094138099, 12.941171317820679],
            ],
            weights: &[],
        },
    ),
    (
        "needle_cut_by_an_oblique_bisector",
        Given {
            room: None,
            positions: &[
                [0.5000000397778638, 0.5000000119333604, 1.7208456881689928e-15],
                [0.49999996022213605, 0.4999999880666397, 0.9999999999999983],
                [0.4999999602221361, 0.4999999880666396, 0.9999999999999982],
            ],
            weights: &[0.25, 0.25000000000000006, 0.24999999999999994],
        },
    ),
    (
        "negative_volume_of_a_sliver_is_rounding",
        Given {
            room: Some((Shape::Plate, Pose::Turned)),
            positions: &[
                [0.3341162009148993, -3.0536235473340643, 13.57938139756133],
                [0.5780120386774201, -4.555164182299494, 12.465159452942695],
                [0.4561042410423882, -3.7984592950217166, 13.01422186813703],
                [0.6999465838099378, -5.307912689713896, 11.910731333005039],
                [0.6999733313074236, -5.303956309850522, 11.905365628261716],
            ],
            weights: &[
                2.0000999999999993,
                0.22223333333333356,
                0.22223333333333356,
                2.0000111111111094,
                2.000011111111112,
            ],
        },
    ),
];
