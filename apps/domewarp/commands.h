// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace domewarp {

/// Each adds one command to the program. When it is chosen on the command line it stores the exit status (0, or 3 for a
/// promise not kept) in `status`; everything else that goes wrong is thrown as Error.
void add_batch_command(CLI::App& app, int& status);
void add_compare_command(CLI::App& app, int& status);
void add_convert_command(CLI::App& app, int& status);
void add_curve_command(CLI::App& app, int& status);
void add_figures_command(CLI::App& app, int& status);
void add_inspect_command(CLI::App& app, int& status);
void add_project_command(CLI::App& app, int& status);
void add_render_command(CLI::App& app, int& status);
void add_scenes_command(CLI::App& app, int& status);
void add_simulate_command(CLI::App& app, int& status);

} // namespace domewarp
