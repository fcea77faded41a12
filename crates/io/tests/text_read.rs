//! Text files of every kind read to exact values, and bad ones to the right error.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod formats_support;

use formats_support::same;
use proptest::prelude::*;
use terrace_io::text::{self, TextError};
use terrace_io::{Cloud, FieldChoice};
use terrace_types::Sigma;

fn read(text: &str) -> Result<Cloud, TextError> {
    text::read(text.as_bytes(), &FieldChoice::Automatic)
}

fn message(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

#[test]
fn every_layout_of_two_points() {
    let files = [
        "1 2 3\n4 5 6.5\n",
        "1 2 3\r\n4 5 6.5\r\n",
        "1 2 3\r4 5 6.5\r",
        "\u{feff}1 2 3\n4 5 6.5",
        "\n  1\t2   3  \n\n 4 \t 5 6.5\n\n",
        "1,2,3\n4,5,6.5\n",
        "1, 2, 3\n4 ,5, 6.5\n",
        "1;2;3;\n4;5;6.5;\n",
        "\"1\",\"2\",\"3\"\n4,5,6.5\n",
        "1 2 3 text 8\n4 5 6.5 more 9\n",
        "2\n1 2 3\n4 5 6.5\n",
        "# comment\n2\n// another\n1 2 3\n# in between\n4 5 6.5\n",
        "x y z\n1 2 3\n4 5 6.5\n",
        "\"X\";\"Y\";\"Z\"\n1;2;3\n4;5;6.5\n",
        "z,name,X,y\n3,a,1,2\n6.5,b,4,5\n",
        "//X Y Z\n1 2 3\n4 5 6.5\n",
        "//X,Z,Y,R\n1,3,2,0\n4,6.5,5,0\n",
        "# z x y\n3 1 2\n6.5 4 5\n",
        "# the points x y z of a scan\n1 2 3\n4 5 6.5\n",
        "# x y z\n# z y x\n3 2 1\n6.5 5 4\n",
        "//Y X Z\n2\n2 1 3\n5 4 6.5\n",
    ];
    for file in files {
        let cloud = read(file).unwrap_or_else(|error| panic!("{file:?}: {error}"));
        assert_eq!(cloud.points, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.5]], "{file:?}");
        assert_eq!((cloud.sigma, cloud.viewpoint, cloud.format), (Sigma::Unknown, None, "text"));
    }
}

#[test]
fn absent_points_keep_their_place() {
    let cloud = read("nan NaN -nan\n-0 inf -1e400\n").unwrap();
    assert!(cloud.points[0].iter().all(|x| x.is_nan()));
    assert!(same(&cloud.points[1..], &[[-0.0, f64::INFINITY, f64::NEG_INFINITY]]));
}

#[test]
fn standard_errors_by_choice() {
    let file = "x,y,z,sigma_x,Sigma_Y,sigma_z,e\n1,2,3,0.1,0.2,0.3,0.4\n";
    let sigma = |choice: &FieldChoice| text::read(file.as_bytes(), choice).map(|cloud| cloud.sigma);
    assert_eq!(sigma(&FieldChoice::Automatic), Ok(Sigma::PerAxis(vec![[0.1, 0.2, 0.3]])));
    assert_eq!(sigma(&FieldChoice::Ignore), Ok(Sigma::Unknown));
    assert_eq!(sigma(&FieldChoice::Named("e".into())), Ok(Sigma::PerPoint(vec![0.4])));
    let missing = sigma(&FieldChoice::Named("E".into())).unwrap_err().to_string();
    assert_eq!(
        missing,
        "line 1: there is no column `E`; the columns are: x, y, z, sigma_x, Sigma_Y, sigma_z, e"
    );
    assert_eq!(read("# x y z sigma\n1 2 3 0.5\n").unwrap().sigma, Sigma::PerPoint(vec![0.5]));
    // Without names the fourth column is not taken for an error.
    assert_eq!(read("1 2 3 0.5\n").unwrap().sigma, Sigma::Unknown);
    let named = text::read(b"1 2 3 0.5\n", &FieldChoice::Named("sigma".into())).unwrap_err().to_string();
    assert_eq!(named, "line 1: there is no column `sigma`; the columns are: x, y, z");
}

#[test]
fn lines_that_are_no_points() {
    assert_eq!(message("1 2 3\n\n4 5 six\n"), "line 3: `six` is not a number");
    assert_eq!(message("1 2 3\n4 5\n"), "line 2 has 2 columns instead of 3");
    assert_eq!(message("1 2 3\n4 5 6 7\n"), "line 2 has 4 columns instead of 3");
    assert_eq!(message("1 2\n"), "line 1 has 2 columns instead of 3");
    assert_eq!(message("1,,3\n"), "line 1: `` is not a number");
    assert_eq!(message("1,2,\n"), "line 1 has 2 columns instead of 3");
    assert_eq!(message("x,y,z\n1,2,3\n1 2 3\n"), "line 3: `1 2 3` is not a number");
    assert_eq!(
        message("x,y,height\n1,2,3\n"),
        "line 1: there is no column `z`; the columns are: x, y, height"
    );
    assert_eq!(message("1 \u{e9} 3\n"), "line 1: `\u{e9}` is not a number");
}

#[test]
fn decimal_commas() {
    for (file, token) in [
        ("1,5;2,5;3,5\n", "1,5"),
        ("x;y;z\n1.5;-2,5;3\n", "-2,5"),
        ("1,5 2,5 3,5\n", "1,5"),
        ("1,5\t2,5\t3,5\n", "1,5"),
        ("1 2 3\n1 2,5 3\n", "2,5"),
    ] {
        let error = read(file).unwrap_err();
        assert!(
            matches!(&error, TextError::DecimalComma { token: t, .. } if t == token),
            "{file:?}: {error}"
        );
    }
}

#[test]
fn empty_and_header_only() {
    assert_eq!(message(""), "the file has no points in its 0 lines");
    assert_eq!(message("\n\n"), "the file has no points in its 2 lines");
    assert_eq!(message("x,y,z\n"), "the file has no points in its 1 lines");
    assert_eq!(message("# x y z\n"), "the file has no points in its 1 lines");
}

#[test]
fn the_number_of_points_is_held_against_them() {
    assert_eq!(message("3\n1 2 3\n4 5 6\n"), "line 1 announces 3 points, but there are 2");
    assert_eq!(message("# few\n1\n1 2 3\n4 5 6\n"), "line 2 announces 1 points, but there are 2");
    assert_eq!(
        message("18446744073709551615\n1 2 3\n"),
        "line 1 announces 18446744073709551615 points, but there are 1"
    );
    assert_eq!(message("18446744073709551616\n1 2 3\n"), "line 1: `18446744073709551616` is not a number");
    assert_eq!(message("-1\n1 2 3\n"), "line 1 has 1 columns instead of 3");
    assert_eq!(message("2\n2\n"), "line 2 has 1 columns instead of 3");
}

proptest! {
    #[test]
    fn what_was_written_is_read(
        points in prop::collection::vec(prop::array::uniform3(prop::num::f64::ANY), 1..30),
        separator in prop::sample::select(&[",", ";", "\t", " ", " , ", "  \t"][..]),
        order in Just([0, 1, 2]).prop_shuffle(),
        header in any::<bool>(),
        end in prop::sample::select(&["\n", "\r\n"][..]),
    ) {
        let order = if header { order } else { [0, 1, 2] };
        let mut text = String::new();
        if header {
            text += &(order.map(|axis| ["x", "y", "z"][axis]).join(separator) + end);
        }
        for point in &points {
            text += &(order.map(|axis| point[axis].to_string()).join(separator) + end);
        }
        prop_assert!(same(&read(&text).unwrap().points, &points));
    }
}
