// SPDX-License-Identifier: Apache-2.0
#include "suggest.h"

#include <algorithm>
#include <numeric>

#include <CLI/CLI.hpp>

#include "options.h"

namespace domewarp {

namespace {

/// Letters to insert, remove or replace (Levenshtein).
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

/// "; did you mean NAME?" for a name at most a third of whose letters are wrong.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const auto nearest = std::min_element(names.begin(), names.end(), [&](const std::string& a, const std::string& b) { return edits(word, a) < edits(word, b); });
  if (nearest == names.end() || 3 * edits(word, *nearest) > word.size()) return "";
  return "; did you mean " + *nearest + "?";
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : all_options(app))
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

} // namespace

std::string unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) names.push_back(command->get_name());
  if (word.starts_with('-') || std::find(names.begin(), names.end(), word) != names.end()) return "";
  return "there is no command '" + word + "'" + did_you_mean(word, names);
}

std::string left_over(const CLI::App& app) {
  const std::vector<const CLI::App*> commands = app.get_subcommands([](const CLI::App* command) { return command->parsed(); });
  const CLI::App& command = commands.empty() ? app : *commands.front();
  const std::vector<std::string> words = app.remaining(true);
  const auto option = std::find_if(words.begin(), words.end(), [](const std::string& word) { return word.starts_with("--"); });
  if (option == words.end()) return command.get_name() + ": '" + words.front() + "' is one word too many";
  const std::string name = option->substr(0, option->find('='));
  return command.get_name() + ": there is no option " + name + did_you_mean(name, option_names(command));
}

} // namespace domewarp
