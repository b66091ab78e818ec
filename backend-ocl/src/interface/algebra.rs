//! The kernels of linear algebra, and their parameters.

use super::table::kernels;

kernels! {
    kernel Multiply = multiply {
        value count: u32,
        value per_row: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input x: f64,
        output y: f64,
        /// Numbers of x and y for each row, and which of them.
        value width: u32,
        value which: u32,
        value subtracts: u32,
    }

    kernel Combine = combine {
        value count: u32,
        value alpha: f64,
        value has_scales: u32,
        input scales: f64,
        input x: f64,
        value beta: f64,
        output y: f64,
    }

    kernel Smooth = smooth {
        value count: u32,
        value per_row: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input inverse: f64,
        value alpha: f64,
        value beta: f64,
        value has_last: u32,
        value is_nothing: u32,
        input last: f64,
        output residual: f64,
        output step: f64,
        output solution: f64,
    }

    kernel DotParts = dot_parts {
        value count: u32,
        input x: f64,
        input y: f64,
        output parts: f64,
    }

    kernel SumParts = sum_parts {
        value count: u32,
        input x: f64,
        output parts: f64,
    }

    kernel SubtractNumber = subtract_number {
        value count: u32,
        value number: f64,
        output x: f64,
    }

    kernel InvertDiagonal = invert_diagonal {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        output inverse: f64,
    }

    kernel FindBeyond = find_beyond {
        value count: u32,
        input x: f64,
        value factor: f64,
        input bounds: f64,
        output is_found: u32,
    }

    kernel FindRisen = find_risen {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input x: f64,
        /// Numbers of each row's cell.
        input cells: f64,
        value share: f64,
        value flattest: f64,
        output is_found: u32,
    }

    kernel Stiffen = stiffen {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input x: f64,
        /// As of `FindRisen`.
        input cells: f64,
        value share: f64,
        value flattest: f64,
        output made_offsets: u32,
        output made_columns: u32,
        output made_values: f64,
    }

    kernel PartCells = part_cells {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        /// As of `FindRisen`.
        input cells: f64,
        value depth: f64,
        output changes: f64,
    }

    kernel RankFree = rank_free {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input inverse: f64,
        value strong: f64,
        input root: u32,
        output ranks: u32,
        output is_found: u32,
    }

    kernel SpreadRanks = spread_ranks {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input inverse: f64,
        value strong: f64,
        input ranks: u32,
        output near: u32,
    }

    kernel ChooseRoots = choose_roots {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input inverse: f64,
        value strong: f64,
        input ranks: u32,
        input near: u32,
        output root: u32,
    }

    kernel JoinRoots = join_roots {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input inverse: f64,
        value strong: f64,
        output root: u32,
    }

    kernel JoinRest = join_rest {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input inverse: f64,
        value strong: f64,
        input root: u32,
        output joined: u32,
        output numbers: u32,
    }

    kernel Prolong = prolong {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input inverse: f64,
        value strong: f64,
        value omega: f64,
        input joined: u32,
        input numbers: u32,
        value fills: u32,
        output starts: u32,
        output made_columns: u32,
        output made_values: f64,
        output is_found: u32,
    }

    kernel CountColumns = count_columns {
        value count: u32,
        input columns: u32,
        output counts: u32,
    }

    kernel ListColumns = list_columns {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input starts: u32,
        output listed: u32,
        output listed_rows: u32,
        output listed_places: u32,
    }

    kernel SortColumns = sort_columns {
        input starts: u32,
        input values: f64,
        input listed_rows: u32,
        input listed_places: u32,
        output made_columns: u32,
        output made_values: f64,
    }

    kernel MultiplyRows = multiply_rows {
        input offsets: u32,
        input columns: u32,
        input values: f64,
        input other_offsets: u32,
        input other_columns: u32,
        input other_values: f64,
        value fills: u32,
        output starts: u32,
        output made_columns: u32,
        output made_values: f64,
        output is_found: u32,
    }

    kernel BalanceRows = balance_rows {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        output values: f64,
    }
}
