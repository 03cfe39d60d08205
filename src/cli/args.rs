//! The arguments, and what they mean to the library.

use super::failure::Failure;
use super::guidance::GuidanceArgs;
use super::sources::SourceArgs;
use crate::options::{
    Cleaning, Fairing, GivenHole, Grouping, Method, Options, Selection, Sizing, Sources,
};
use crate::sample::{Break, Sample};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

const EXIT_CODES: &str = "Exit codes: 0 done, 1 a hole could not be filled, 2 wrong usage, \
3 a file cannot be read or written, 4 the mesh or an option is invalid, 130 interrupted.";

/// Fills the holes of triangle meshes; keeps every input vertex and face bit for bit.
#[derive(Debug, Parser)]
#[command(name = "complete-mesh", version, about, after_help = EXIT_CODES)]
#[command(subcommand_required = true, arg_required_else_help = true)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub command: Command,
    /// Print machine-readable lines on stdout, one JSON object each
    #[arg(long, global = true)]
    pub json: bool,
    /// Print warnings and errors only
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Fill the holes of a mesh file
    Fill(Box<FillArgs>),
    /// List the holes of a mesh file
    Holes(HolesArgs),
    /// Break a fluted column, complete it and draw a picture of both
    Demo(DemoArgs),
    /// Make a procedural model, whole or broken
    Sample(SampleArgs),
}

/// The names of the methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum MethodName {
    Smooth,
    Coherent,
    Harary,
    Warp,
    Fragment,
}

#[derive(Debug, Args)]
pub(super) struct FillArgs {
    /// Mesh file to read
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Mesh file to write; its name's ending says the format. May be IN itself
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// How a fill is made
    #[arg(long, value_enum, default_value = "coherent")]
    pub method: MethodName,
    /// The smooth surface, which a coherent fill starts from
    #[arg(long, default_value = "auto", value_name = "NAME", value_parser = fairing_parser())]
    pub fairing: Fairing,
    #[command(flatten)]
    pub selection: SelectionArgs,
    #[command(flatten)]
    pub grouping: GroupingArgs,
    #[command(flatten)]
    pub given: GivenArgs,
    #[command(flatten)]
    pub sizing: SizingArgs,
    /// Start from this completion of the same mesh, not from a smooth one
    #[arg(long, value_name = "FILE")]
    pub initial: Option<PathBuf>,
    #[command(flatten)]
    pub sources: SourceArgs,
    #[command(flatten)]
    pub guidance: GuidanceArgs,
    /// Of a point cloud: complete a cleaned copy, without outliers, its noise smoothed ROUNDS times (3
    /// unless said). The points of IN are written as they are
    #[arg(long, value_name = "ROUNDS", num_args = 0..=1, require_equals = true, default_missing_value = "3")]
    pub clean: Option<usize>,
    /// Write the cleaned copy, too, with the new points
    #[arg(long, value_name = "FILE", requires = "clean")]
    pub cleaned: Option<PathBuf>,
    /// Leave holes open that cannot be filled safely, instead of writing nothing
    #[arg(long)]
    pub skip_unsafe: bool,
    /// Write a report in JSON
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Say of each vertex in the output where it comes from (PLY)
    #[arg(long)]
    pub provenance: bool,
    /// Write a picture (PNG): before and after, with a close-up on each hole
    #[arg(long, value_name = "FILE", value_parser = parse_picture)]
    pub picture: Option<PathBuf>,
    /// Colour the fill in the picture by its sources, and the sources in the same colours
    #[arg(long, requires = "picture")]
    pub tint: bool,
    /// Worker threads; 0: as many as the machine has cores
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub threads: usize,
}

/// Which holes are filled: one of these at most.
#[derive(Debug, Default, Args)]
#[group(id = "selection", multiple = false)]
pub(super) struct SelectionArgs {
    /// all, all-but-largest, or ids separated by commas
    #[arg(long, value_name = "WHICH", value_parser = parse_holes)]
    pub holes: Option<Selection>,
    /// Holes of at most so many edges
    #[arg(long, value_name = "N")]
    pub max_edges: Option<usize>,
    /// Holes of at most this circumference, in mesh units
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    pub max_length: Option<f64>,
    /// Holes of at most this diameter, in mesh units
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    pub max_diameter: Option<f64>,
    /// The hole whose rim passes nearest to a point
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    pub near: Option<[f64; 3]>,
    /// The holes at, or nearest to, these vertices
    #[arg(long, value_name = "I,..", value_delimiter = ',')]
    pub near_vertex: Option<Vec<u32>>,
}

/// Which loops make one hole.
#[derive(Debug, Default, Args)]
#[group(id = "grouping", multiple = false)]
pub(super) struct GroupingArgs {
    /// Loops that are filled together, each named by one of its vertices: "1,2;3,4"
    #[arg(long, value_name = "V1,V2[;V3,V4]", value_parser = parse_join)]
    pub join: Option<Join>,
    /// Fill every loop on its own
    #[arg(long)]
    pub separate_loops: bool,
}

/// Groups of loops, by vertices; a type of its own, or clap takes it for a repeated argument.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Join(pub Vec<Vec<u32>>);

/// The size of the new triangles.
#[derive(Debug, Default, Args)]
#[group(id = "sizing", multiple = false)]
pub(super) struct SizingArgs {
    /// Edge length of the new triangles, in mesh units
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    pub edge_length: Option<f64>,
    /// Edge length of the new triangles, as a factor on the surroundings' (0.05 to 20)
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    pub edge_scale: Option<f64>,
    /// Triangulate the rims only
    #[arg(long)]
    pub no_refine: bool,
}

#[derive(Debug, Args)]
pub(super) struct HolesArgs {
    /// Mesh file to read
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    #[command(flatten)]
    pub grouping: GroupingArgs,
    #[command(flatten)]
    pub given: GivenArgs,
}

/// Holes of a point cloud that are given instead of being found.
#[derive(Debug, Default, Args)]
pub(super) struct GivenArgs {
    /// Of a point cloud: a hole, by the points around it in order; may be repeated. Other holes are not looked
    /// for
    #[arg(long = "loop", value_name = "I,I,I,..", value_parser = parse_loop)]
    pub loops: Vec<Loop>,
    /// Of a point cloud: the holes in this ball, or the largest gap there; may be repeated. Other holes are not
    /// looked for
    #[arg(long = "region", value_name = "X,Y,Z,R", value_parser = parse_region, allow_hyphen_values = true)]
    pub regions: Vec<[f64; 4]>,
}

/// Points of a loop; a type of its own, or clap takes it for a repeated argument.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Loop(pub Vec<u32>);

impl GivenArgs {
    /// The library's given holes.
    pub fn holes(&self) -> Vec<GivenHole> {
        let region =
            |&[x, y, z, radius]: &[f64; 4]| GivenHole::Region { centre: [x, y, z], radius };
        let loops = self.loops.iter().map(|l| GivenHole::Loop(l.0.clone()));
        loops.chain(self.regions.iter().map(region)).collect()
    }

    /// Refuses them for a mesh.
    pub fn none_of_a_mesh(&self) -> Result<(), Failure> {
        match self.holes().is_empty() {
            true => Ok(()),
            false => Err(Failure::Usage(
                "--loop and --region take a point cloud; choose among a mesh's holes with --near or \
                 --near-vertex"
                    .into(),
            )),
        }
    }
}

#[derive(Debug, Args)]
pub(super) struct DemoArgs {
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "complete-mesh-demo")]
    pub out_dir: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct SampleArgs {
    /// Which model
    #[arg(value_name = "NAME", value_parser = sample_parser())]
    pub sample: Sample,
    /// Mesh file to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Break a piece off
    #[arg(long = "break", value_name = "KIND", value_parser = break_parser())]
    pub broken: Option<Break>,
    /// Write the piece that was broken off
    #[arg(long, value_name = "FILE", requires = "broken")]
    pub truth: Option<PathBuf>,
    /// Another number breaks it another way
    #[arg(long, default_value_t = 1, requires = "broken", value_name = "N")]
    pub seed: u64,
    /// Size of the piece, as a factor on the model's own (0.2 to 1.5)
    #[arg(long, default_value_t = 1.0, requires = "broken", value_name = "F")]
    pub size: f64,
    /// With colours: the vessel has them
    #[arg(long)]
    pub painted: bool,
    /// Edges along the longest side (24 to 4000)
    #[arg(long, default_value_t = 200, value_name = "N")]
    pub resolution: usize,
}

impl FillArgs {
    /// The library's options but for the sources, which take the mesh to be told.
    pub fn options(&self) -> Result<Options, Failure> {
        let method = match self.method {
            MethodName::Smooth => Method::Smooth,
            MethodName::Coherent => Method::Coherent,
            MethodName::Harary => Method::Harary,
            MethodName::Fragment => Method::Fragment,
            MethodName::Warp => Method::Warp,
        };
        let options = Options {
            appearance: None,
            guidance: self.guidance.guidance()?,
            method,
            selection: self.selection.selection(),
            grouping: self.grouping.grouping(),
            fairing: self.fairing,
            sizing: self.sizing.sizing(),
            clean: self.clean.map(|rounds| Cleaning { rounds }),
            given_holes: self.given.holes(),
            skip_unsafe: self.skip_unsafe,
            initial: None,
            sources: Sources::default(),
            threads: self.threads,
        };
        options.check()?;
        Ok(options)
    }
}

impl SelectionArgs {
    fn selection(&self) -> Selection {
        let Self { holes, max_edges, max_length, max_diameter, near, near_vertex } = self;
        holes
            .clone()
            .or(max_edges.map(Selection::MaxEdges))
            .or(max_length.map(Selection::MaxCircumference))
            .or(max_diameter.map(Selection::MaxDiameter))
            .or(near.map(Selection::NearPoint))
            .or(near_vertex.clone().map(Selection::NearVertices))
            .unwrap_or_default()
    }
}

impl GroupingArgs {
    /// The library's grouping.
    pub fn grouping(&self) -> Grouping {
        match &self.join {
            Some(Join(groups)) => Grouping::Join(groups.clone()),
            None if self.separate_loops => Grouping::Separate,
            None => Grouping::Automatic,
        }
    }
}

impl SizingArgs {
    fn sizing(&self) -> Sizing {
        match (self.edge_length, self.edge_scale) {
            (Some(length), _) => Sizing::EdgeLength(length),
            (_, Some(factor)) => Sizing::Scaled(factor),
            _ if self.no_refine => Sizing::None,
            _ => Sizing::Surroundings,
        }
    }
}

/// A parser that takes one of some names and lists them in the help.
fn by_name<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(all.iter().map(|&t| name(t)))
        .try_map(move |text| all.iter().copied().find(|&t| name(t) == text).ok_or("unknown name"))
}

fn fairing_parser() -> impl TypedValueParser<Value = Fairing> {
    by_name(&Fairing::ALL, Fairing::name)
}

fn sample_parser() -> impl TypedValueParser<Value = Sample> {
    by_name(&Sample::ALL, Sample::name)
}

fn break_parser() -> impl TypedValueParser<Value = Break> {
    by_name(&Break::ALL, Break::name)
}

fn parse_holes(text: &str) -> Result<Selection, String> {
    match text {
        "all" => Ok(Selection::All),
        "all-but-largest" => Ok(Selection::AllButLargest),
        ids => {
            let ids = ids.split(',').map(|id| id.trim().parse()).collect::<Result<Vec<_>, _>>();
            ids.map(Selection::Ids)
                .map_err(|_| "use all, all-but-largest, or ids such as 0,3,7".to_owned())
        }
    }
}

/// A file name without an ending, or with that of what is written.
fn parse_picture(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(other) if !other.eq_ignore_ascii_case("png") => {
            Err(format!("the picture is a PNG: name it {}", path.with_extension("png").display()))
        }
        _ => Ok(path),
    }
}

fn parse_point(text: &str) -> Result<[f64; 3], String> {
    parse_numbers(text, "three", "0.5,-1,2")
}

fn parse_region(text: &str) -> Result<[f64; 4], String> {
    parse_numbers(text, "four", "0.5,-1,2,0.1")
}

fn parse_numbers<const N: usize>(
    text: &str,
    count: &str,
    example: &str,
) -> Result<[f64; N], String> {
    let parts: Vec<f64> = text
        .split(',')
        .map(|x| x.trim().parse())
        .collect::<Result<_, _>>()
        .map_err(|_| format!("use {count} numbers such as {example}"))?;
    parts.try_into().map_err(|p: Vec<f64>| format!("{} numbers instead of {count}", p.len()))
}

fn parse_loop(text: &str) -> Result<Loop, String> {
    let points = text.split(',').map(|p| p.trim().parse()).collect::<Result<_, _>>();
    points.map(Loop).map_err(|_| "use numbers of points in order such as 12,340,341,97".to_owned())
}

fn parse_join(text: &str) -> Result<Join, String> {
    let group = |part: &str| -> Result<Vec<u32>, String> {
        let vertices: Vec<u32> = part
            .split(',')
            .map(|v| v.trim().parse())
            .collect::<Result<_, _>>()
            .map_err(|_| "use vertex numbers such as 12,340;7,99".to_owned())?;
        if vertices.len() < 2 {
            return Err(format!("\"{part}\" names one loop: two or more are joined"));
        }
        Ok(vertices)
    };
    text.split(';').map(group).collect::<Result<_, _>>().map(Join)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(line: &str) -> Result<Box<FillArgs>, clap::Error> {
        let words = "complete-mesh fill in.ply -o out.ply".split(' ');
        let cli = Cli::try_parse_from(words.chain(line.split_whitespace()))?;
        match cli.command {
            Command::Fill(args) => Ok(args),
            other => panic!("{other:?}"),
        }
    }

    fn options(line: &str) -> Options {
        fill(line).unwrap().options().unwrap()
    }

    #[test]
    fn the_definition_is_sound() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
    }

    #[test]
    fn without_flags_the_options_are_the_defaults() {
        assert_eq!(options(""), Options::default());
        assert_eq!(options("--method coherent --report r.json"), Options::default());
        assert_eq!(options("--method smooth").method, Method::Smooth);
    }

    #[test]
    fn every_selection_flag_reaches_the_library() {
        for (line, selection) in [
            ("--holes all", Selection::All),
            ("--holes all-but-largest", Selection::AllButLargest),
            ("--holes 1,4,7", Selection::Ids(vec![1, 4, 7])),
            ("--max-edges 30", Selection::MaxEdges(30)),
            ("--max-length 2.5", Selection::MaxCircumference(2.5)),
            ("--max-diameter 0.5", Selection::MaxDiameter(0.5)),
            ("--near -1,2.5,-3e-1", Selection::NearPoint([-1.0, 2.5, -0.3])),
            ("--near-vertex 5", Selection::NearVertices(vec![5])),
            ("--near-vertex 5,8", Selection::NearVertices(vec![5, 8])),
        ] {
            assert_eq!(options(line).selection, selection, "{line}");
        }
    }

    #[test]
    fn grouping_sizing_and_fairing_reach_the_library() {
        assert_eq!(options("--separate-loops").grouping, Grouping::Separate);
        let join = options("--join 1,2;3,4,5").grouping;
        assert_eq!(join, Grouping::Join(vec![vec![1, 2], vec![3, 4, 5]]));
        assert_eq!(options("--edge-length 0.5").sizing, Sizing::EdgeLength(0.5));
        assert_eq!(options("--edge-scale 2").sizing, Sizing::Scaled(2.0));
        assert_eq!(options("--no-refine").sizing, Sizing::None);
        for fairing in Fairing::ALL {
            assert_eq!(options(&format!("--fairing {}", fairing.name())).fairing, fairing);
        }
        let more = options("--skip-unsafe --threads 3");
        assert!(more.skip_unsafe && more.threads == 3);
    }

    #[test]
    fn contradictions_and_nonsense_are_usage_errors() {
        for line in [
            "--holes 1 --max-edges 3",
            "--near 0,0,0 --near-vertex 1",
            "--max-length 1 --max-diameter 1",
            "--join 1,2 --separate-loops",
            "--edge-length 1 --no-refine",
            "--holes one",
            "--holes 1,",
            "--near 1,2",
            "--join 1",
            "--fairing c9",
            "--method smoth",
            "--threads -1",
            "--tint",
        ] {
            let error = fill(line).expect_err(line);
            assert!(error.use_stderr(), "{line}");
        }
        let both = fill("--holes 1 --max-edges 3").unwrap_err().to_string();
        assert!(both.contains("--holes") && both.contains("--max-edges"), "{both}");
    }

    #[test]
    fn values_out_of_range_are_refused_before_any_file_is_read() {
        for line in ["--edge-length 0", "--edge-scale 100", "--max-length -1", "--near nan,0,0"] {
            assert_eq!(fill(line).unwrap().options().unwrap_err().code(), 4, "{line}");
        }
    }
}
