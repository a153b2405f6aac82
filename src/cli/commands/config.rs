//! `taxel config`: prints the settings in force, as a settings file.

use crate::cli::Context;
use crate::cli::arguments::parameters::SensorFlags;
use crate::cli::commands::screen::Look;
use crate::cli::failure::Failure;

const EXAMPLES: &str = r#"The output is itself a settings file. Yours is ~/.config/taxel/config.toml on
Linux, or the file that --config or TAXEL_CONFIG names. An example:
  theme = "light"
  charset = "ascii"             # as the flag --ascii
  library = "~/shapes"
  [sensor]
  columns = 32
  [keys.matrix]                 # place, key, action; "none" frees a key
  "x" = "toggle"
  "<C-n>" = "new"
Flags override the environment, which overrides the file. If the file has
an unknown entry, taxel names its line and column and does not start. Scripts
ignore the settings unless you give --config, so they run alike for everybody.

Examples:
  taxel config
  taxel config --theme light --columns 32
  TAXEL_CONFIG=/dev/null taxel config | grep keys"#;

/// Print the settings in force, and the path of their file
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Config {
    #[command(flatten)]
    look: Look,
    #[command(flatten)]
    sensor: SensorFlags,
}

impl Config {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let settings = cx.settings.with(&self.look, &self.sensor)?;
        cx.print(&settings.text()?)
    }
}
