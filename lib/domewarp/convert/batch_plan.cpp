// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/batch_plan.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <memory>
#include <set>
#include <system_error>

#include "domewarp/convert/manifest.h"
#include "domewarp/convert/stamp.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"

namespace domewarp {

namespace {

namespace fs = std::filesystem;

using Arguments = std::vector<JobArgument>;

/// Options of which the last one given counts.
const std::array<std::set<std::string>, 4> alternatives = {
    std::set<std::string>{"curve", "lens", "profile"}, {"target", "forward"}, {"eye", "camera"}, {"shading", "unlit"}};

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

bool is_scene_name(const fs::path& path) { return lower_extension(path) == ".glb" || lower_extension(path) == ".gltf"; }

/// `base` overruled by the options of a manifest.
Arguments overrule(Arguments base, const std::vector<ManifestOption>& options, const std::string& path, const fs::path& manifest) {
  std::set<std::string> replaced;
  for (const ManifestOption& option : options) {
    replaced.insert(option.name);
    if (option.kind == ManifestOption::Kind::off) continue;
    for (const auto& group : alternatives)
      if (group.contains(option.name)) replaced.insert(group.begin(), group.end());
  }
  std::erase_if(base, [&](const JobArgument& argument) { return replaced.contains(argument.name); });
  for (const ManifestOption& option : options) {
    if (option.kind == ManifestOption::Kind::off) continue;
    const std::string where = to_string(manifest.string(), option.place) + ": " + path + "." + option.name;
    if (option.kind == ManifestOption::Kind::on)
      base.push_back({option.name, std::nullopt, where});
    else
      base.push_back({option.name, option.name == "profile" ? (manifest.parent_path() / option.value).string() : option.value, where});
  }
  return base;
}

std::string canonical_text(const Arguments& arguments) {
  std::set<std::string> lines;
  for (const JobArgument& argument : arguments) lines.insert(argument.name + (argument.value ? "=" + *argument.value : ""));
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

/// A scene that is wanted, its output not yet settled.
struct Wish {
  fs::path input;
  fs::path output;       ///< relative; without extension when `derived`
  bool derived = true;
  const Arguments* arguments = nullptr;
  std::string where;     ///< of the manifest, for messages; empty for the command line
};

class Planner {
public:
  explicit Planner(const PlanOptions& options) : options_(options) {
    std::error_code status;
    out_ = fs::weakly_canonical(options.out, status);
  }

  std::vector<BatchItem> plan(const std::vector<std::string>& inputs) {
    for (const std::string& input : inputs) {
      if (lower_extension(input) == ".json")
        add_manifest(input);
      else
        add_input(input, {}, {}, options_.arguments, {});
    }
    if (wishes_.empty()) throw Error(ErrorCode::input, inputs.front() + ": holds no .glb or .gltf file");
    remove_repeated();
    std::vector<BatchItem> items = settle_outputs();
    std::sort(items.begin(), items.end(), [](const BatchItem& a, const BatchItem& b) { return a.output < b.output; });
    return items;
  }

private:
  /// @param kept folder below the output folder; @param named by a manifest, or empty
  void add_input(const fs::path& input, const fs::path& kept, const fs::path& named, const Arguments& arguments, const std::string& where) {
    std::error_code status;
    if (fs::is_directory(input, status)) return add_folder(input, named.empty() ? kept : named, arguments, where);
    if (named.empty())
      wishes_.push_back({input, (kept / input.filename()).replace_extension(), true, &arguments, where});
    else
      wishes_.push_back({input, named, false, &arguments, where});
  }

  void add_folder(const fs::path& folder, const fs::path& kept, const Arguments& arguments, const std::string& where) {
    std::error_code status;
    fs::recursive_directory_iterator entry(folder, status), end;
    for (; !status && entry != end; entry.increment(status)) {
      const bool is_hidden = entry->path().filename().string().starts_with('.');
      if (entry->is_directory(status)) {
        if (is_hidden || is_output_folder(entry->path())) entry.disable_recursion_pending();
        continue;
      }
      if (is_hidden || !is_scene_name(entry->path()) || !entry->is_regular_file(status)) continue;
      const fs::path below = entry->path().lexically_relative(folder);
      wishes_.push_back({entry->path(), (kept / below).replace_extension(), true, &arguments, where});
    }
    if (status) throw Error(ErrorCode::input, folder.string() + ": cannot be searched: " + status.message());
  }

  /// Of this batch or an earlier one.
  bool is_output_folder(const fs::path& folder) const {
    std::error_code status;
    return fs::weakly_canonical(folder, status) == out_ || fs::is_directory(folder / stamp_folder, status);
  }

  void add_manifest(const fs::path& path) {
    const std::vector<std::uint8_t> bytes = read_file(path);
    const Manifest manifest = parse_manifest({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path.string());
    const Arguments defaults = overrule(options_.arguments, manifest.defaults, "defaults", path);
    for (std::size_t i = 0; i < manifest.scenes.size(); ++i) {
      const ManifestScene& scene = manifest.scenes[i];
      const std::string key = "scenes[" + std::to_string(i) + "]", where = to_string(path.string(), scene.place) + ": " + key;
      check_inside(scene.output, where);
      kept_arguments_.push_back(std::make_unique<const Arguments>(overrule(defaults, scene.options, key, path)));
      const fs::path input = scene.input, folder = input.parent_path().lexically_normal();
      const bool climbs = input.is_absolute() || folder.string().starts_with("..");
      add_input(path.parent_path() / input, climbs ? fs::path() : folder, scene.output, *kept_arguments_.back(), where);
    }
  }

  static void check_inside(const fs::path& output, const std::string& where) {
    const fs::path normal = output.lexically_normal();
    if (output.is_absolute() || normal.string().starts_with("..") || (!normal.empty() && normal.begin()->string() == stamp_folder))
      throw Error(ErrorCode::input, where + ".output: must stay inside the output folder, got '" + output.string() + "'");
  }

  /// A file that is named twice, by itself and in a folder, is one scene.
  void remove_repeated() {
    std::set<std::string> seen;
    std::erase_if(wishes_, [&](const Wish& wish) {
      std::error_code status;
      return !seen.insert(fs::weakly_canonical(wish.input, status).string() + '\n' + wish.output.string() + '\n' + canonical_text(*wish.arguments)).second;
    });
  }

  fs::path output_of(const Wish& wish, bool spell_extension) const {
    if (!wish.derived) return wish.output.has_extension() ? wish.output : fs::path(wish.output.string() + options_.extension);
    std::string stem = wish.output.string();
    const std::string extension = lower_extension(wish.input); // with its dot
    if (spell_extension) stem.append("_").append(extension, std::min<std::size_t>(1, extension.size()));
    const fs::path file = stem + options_.extension;
    return options_.extension == ".gltf" ? fs::path(stem) / file.filename() : file;
  }

  std::vector<BatchItem> settle_outputs() {
    std::map<fs::path, int> wanted;
    for (const Wish& wish : wishes_) ++wanted[output_of(wish, false).lexically_normal()];
    std::map<fs::path, const Wish*> taken, folders;
    std::set<fs::path> inputs;
    std::error_code status;
    for (const Wish& wish : wishes_) inputs.insert(fs::weakly_canonical(wish.input, status));
    std::vector<BatchItem> items;
    for (const Wish& wish : wishes_) {
      const bool alone = wanted[output_of(wish, false).lexically_normal()] == 1;
      const fs::path output = output_of(wish, !alone).lexically_normal();
      require_free(taken, output, wish);
      if (inputs.contains(fs::weakly_canonical(options_.out / output, status)))
        throw Error(ErrorCode::usage, (options_.out / output).string() + ": is a scene to convert and would be overwritten; --out needs another folder");
      if (lower_extension(output) == ".gltf") require_free(folders, output.parent_path() / "", wish);
      items.push_back({wish.input, output, canonical_text(*wish.arguments), parse(wish)});
    }
    return items;
  }

  void require_free(std::map<fs::path, const Wish*>& taken, const fs::path& output, const Wish& wish) const {
    const auto [other, is_new] = taken.emplace(output, &wish);
    if (is_new) return;
    throw Error(ErrorCode::input, (wish.where.empty() ? "" : wish.where + ": ") + wish.input.string() + " and " + other->second->input.string() +
                                      " would both be written to " + (options_.out / output).string() +
                                      (output.has_filename() ? "" : " with their side files"));
  }

  std::shared_ptr<const JobOptions> parse(const Wish& wish) {
    std::shared_ptr<const JobOptions>& parsed = parsed_[canonical_text(*wish.arguments)];
    if (parsed) return parsed;
    try {
      parsed = std::make_shared<const JobOptions>(options_.parse(*wish.arguments));
    } catch (const Error& error) {
      const std::string message = error.what();
      const bool names_place = std::any_of(wish.arguments->begin(), wish.arguments->end(), [&](const JobArgument& a) { return message.starts_with(a.where); });
      if (wish.where.empty()) throw;
      throw Error(ErrorCode::input, names_place ? message : wish.where + ": " + message);
    }
    return parsed;
  }

  const PlanOptions& options_;
  fs::path out_;
  std::vector<Wish> wishes_;
  std::vector<std::unique_ptr<const Arguments>> kept_arguments_;
  std::map<std::string, std::shared_ptr<const JobOptions>> parsed_;
};

} // namespace

std::vector<BatchItem> plan_batch(const std::vector<std::string>& inputs, const PlanOptions& options) { return Planner(options).plan(inputs); }

std::vector<BatchItem> shard(const std::vector<BatchItem>& items, std::size_t index, std::size_t count) {
  std::vector<BatchItem> part;
  for (std::size_t i = index - 1; i < items.size(); i += count) part.push_back(items[i]);
  return part;
}

} // namespace domewarp
