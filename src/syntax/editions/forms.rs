//! The table: each command, in each order of arguments, with the editions that have it so.

use crate::syntax::editions::{Edition, Editions};
use crate::syntax::spec::{ArgSpec, Arguments, COMMANDS, CommandKind, RADIUS, Range, Unit, share, world};

/// A command as some editions have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// Its name in a scene.
    pub name: &'static str,
    /// The editions that have it in this form.
    pub editions: Editions,
    /// What follows the name, with ranges.
    pub arguments: Arguments,
    /// What its numbers must be together.
    pub law: Law,
}

/// A condition on several numbers of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// None.
    Free,
    /// The first of these two is below the second.
    Rising(usize, usize),
    /// Three numbers from this one on are not all 0.
    NotZero(usize),
    /// Its nine numbers are three vectors that span the space.
    Spanning,
}

impl Law {
    /// Tells whether the numbers of a command keep it.
    #[must_use]
    pub fn allows(self, numbers: &[f64]) -> bool {
        match (self, numbers) {
            (Self::Free, _) => true,
            (Self::Rising(low, high), _) => numbers[low] < numbers[high],
            (Self::NotZero(first), _) => numbers[first..first + 3].iter().any(|number| *number != 0.0),
            (Self::Spanning, &[ux, uy, uz, vx, vy, vz, wx, wy, wz]) => {
                ux * (vy * wz - vz * wy) - uy * (vx * wz - vz * wx) + uz * (vx * wy - vy * wx) != 0.0
            }
            (Self::Spanning, _) => false,
        }
    }
}

impl Form {
    /// Returns the numbers that it takes; none for a file name.
    #[must_use]
    pub const fn numbers(&self) -> &'static [ArgSpec] {
        match self.arguments {
            Arguments::Numbers(args) => args,
            Arguments::FileName(_) => &[],
        }
    }

    /// Tells whether a scene may hold a command with these numbers, as many as it takes.
    #[must_use]
    pub fn allows(&self, numbers: &[f64]) -> bool {
        let args = self.numbers();
        args.len() == numbers.len()
            && args.iter().zip(numbers).all(|(arg, number)| arg.range.allows(*number))
            && self.law.allows(numbers)
    }

    /// Returns the command as one writes it down, a group of like numbers as one word where that is shorter.
    #[must_use]
    pub fn usage(&self) -> String {
        let names: Vec<_> = match self.arguments {
            Arguments::Numbers(args) => args.iter().map(|arg| arg.name).collect(),
            Arguments::FileName(arg) => vec![arg.name],
        };
        names.into_iter().fold(self.name.to_owned(), |usage, name| usage + " " + name)
    }
}

use Edition::{Y2014, Y2017, Y2018, Y2019, Y2020, Y2022};

const ALL: Editions = Editions::of(&Edition::BY_PREFERENCE);
const OURS: Editions = Editions::of(&[Y2018]);
/// All editions but 2018.
const OTHERS: Editions = Editions::of(&[Y2014, Y2017, Y2019, Y2020, Y2022]);
const WITH_TRIANGLES: Editions = Editions::of(&[Y2014, Y2017, Y2022]);
const WITH_CAMERA: Editions = Editions::of(&[Y2019, Y2020, Y2022]);
const WITH_WRITE: Editions = Editions::of(&[Y2014, Y2017, Y2018, Y2019, Y2020]);

const X: ArgSpec = world("x", "to the right");
const Y: ArgSpec = world("y", "up");
const Z: ArgSpec = world("z", "towards the viewer");

const fn length(name: &'static str, doc: &'static str) -> ArgSpec {
    ArgSpec { name, unit: Unit::World, range: Range::Positive, doc }
}

const fn numbers(args: &'static [ArgSpec]) -> Arguments {
    Arguments::Numbers(args)
}

/// Makes the form that a command of 2018 has, in `editions`.
const fn as_in_2018(kind: CommandKind, editions: Editions) -> Form {
    let command = &COMMANDS[kind as usize];
    let law = match command.rising {
        Some((low, high)) => Law::Rising(low, high),
        None => Law::Free,
    };
    Form { name: command.name, editions, arguments: command.arguments, law }
}

const fn form(name: &'static str, editions: Editions, arguments: Arguments, law: Law) -> Form {
    Form { name, editions, arguments, law }
}

/// Every form of every command, by name.
pub static FORMS: [Form; 19] = [
    as_in_2018(CommandKind::Fov, ALL),
    as_in_2018(CommandKind::Background, ALL),
    form("eye", WITH_CAMERA, numbers(&[X, Y, Z]), Law::Free),
    form(
        "uvw",
        WITH_CAMERA,
        numbers(&[
            world("ux", "to the right of the image, x"),
            world("uy", "to the right of the image, y"),
            world("uz", "to the right of the image, z"),
            world("vx", "up in the image, x"),
            world("vy", "up in the image, y"),
            world("vz", "up in the image, z"),
            world("wx", "towards the viewer, x"),
            world("wy", "towards the viewer, y"),
            world("wz", "towards the viewer, z"),
        ]),
        Law::Spanning,
    ),
    as_in_2018(CommandKind::Light, OURS),
    form("light", OTHERS, numbers(&[X, Y, Z, share("r", "red"), share("g", "green"), share("b", "blue")]), Law::Free),
    as_in_2018(CommandKind::Surface, OURS),
    form(
        "surface",
        OTHERS,
        numbers(&[
            share("Cdr", "diffuse red"),
            share("Cdg", "diffuse green"),
            share("Cdb", "diffuse blue"),
            share("Car", "ambient red"),
            share("Cag", "ambient green"),
            share("Cab", "ambient blue"),
            share("Csr", "specular red"),
            share("Csg", "specular green"),
            share("Csb", "specular blue"),
            ArgSpec { name: "P", unit: Unit::Exponent, range: Range::NotNegative, doc: "the shininess" },
            share("Krefl", "the weight of the mirror image"),
        ]),
        Law::Free,
    ),
    as_in_2018(CommandKind::Sphere, OURS),
    form("sphere", Editions::of(&[Y2014, Y2017, Y2019, Y2022]), numbers(&[RADIUS, X, Y, Z]), Law::Free),
    as_in_2018(CommandKind::Cylinder, OURS),
    form(
        "cone",
        Editions::of(&[Y2019]),
        numbers(&[X, Y, Z, length("h", "the height"), length("k", "the radius at the top over the height")]),
        Law::Free,
    ),
    form(
        "disk",
        Editions::of(&[Y2020]),
        numbers(&[
            X,
            Y,
            Z,
            world("nx", "the normal, x"),
            world("ny", "the normal, y"),
            world("nz", "the normal, z"),
            RADIUS,
        ]),
        Law::NotZero(3),
    ),
    form(
        "ellipsoid",
        Editions::of(&[Y2020]),
        numbers(&[
            X,
            Y,
            Z,
            length("rx", "the radius along x"),
            length("ry", "the radius along y"),
            length("rz", "the radius along z"),
        ]),
        Law::Free,
    ),
    form("begin", WITH_TRIANGLES, numbers(&[]), Law::Free),
    form("vertex", WITH_TRIANGLES, numbers(&[X, Y, Z]), Law::Free),
    form("end", WITH_TRIANGLES, numbers(&[]), Law::Free),
    as_in_2018(CommandKind::Write, WITH_WRITE),
    form("render", Editions::of(&[Y2022]), numbers(&[]), Law::Free),
];
