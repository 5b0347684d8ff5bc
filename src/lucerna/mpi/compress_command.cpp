// SPDX-License-Identifier: Apache-2.0
#include "lucerna/mpi/compress_command.h"

#include <fmt/format.h>

#include <csignal>
#include <filesystem>
#include <memory>
#include <string>

#include "lucerna/cli/output/compress_output.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/cli/parse/compress_arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/distributed/distributed_trace.h"
#include "lucerna/distributed/rank_peers.h"
#include "lucerna/mpi/together.h"
#include "lucerna/ray_file.h"
#include "lucerna/source/model/compress_files.h"
#include "lucerna/version.h"

namespace lucerna::cli {

namespace {

/// What all ranks have to have alike. Files may be larger than a machine reads in an hour: they are told
/// apart by size, format and number of rays.
std::string identity(const CompressArguments& a) {
  std::string text = fmt::format("{} {}", version(), best_isa());
  for (const std::filesystem::path& file : a.files()) {
    const auto reader = open_ray_file(file);
    text += fmt::format("; {} bytes, {}, {} rays", std::filesystem::file_size(file), reader->format(),
                        reader->ray_count());
  }
  return text;
}

/// Errors of the reading are on all ranks, and what follows is computed by each of them alike.
CompressedFiles compressed(const CompressArguments& a, const CompressOptions& options, Session& session,
                           RankPeers& peers, Ranks& ranks) {
  CompressedFiles made;
  std::string error;
  try {
    made = session.timed("compress",
                         [&] { return compress_files(a.files(), options, &peers, peers.progress()); });
  } catch (const InputError& e) {
    error = e.what();
  }
  agree(ranks, error);
  return made;
}

void run_mpi_compress(const CompressArguments& a, Session& session, Ranks& ranks) {
  session.quiet = session.quiet || !ranks.is_first();
  session.start();
  session.stop_on_signal(SIGUSR1);
  const CompressOptions options = compress_options(a);
  together(ranks, [&] {
    if (ranks.is_first()) check_compress(a);
  });
  std::string own;
  together(ranks, [&] { own = identity(a); });
  agree_on_same(ranks, "version, instruction set and ray files", own);
  RankPeers peers(ranks, session.progress());
  const CompressedFiles made = compressed(a, options, session, peers, ranks);
  peers.gather({});  // one that was asked to stop since the reading stops all
  peers.progress().step("compress: write", 0, 1);
  together(ranks, [&] {
    if (ranks.is_first()) write_compress_output(a, made, session);
  });
}

}  // namespace

void add_mpi_compress(CLI::App& app, Session& session, Ranks& ranks) {
  Command command(app, "compress", "Make a small source model of ray files, which all ranks read together");
  auto arguments = std::make_shared<CompressArguments>();
  add_compress_options(command, *arguments, session);
  command.on_run([arguments, &session, &ranks] {
    or_abort(ranks, [&] { run_mpi_compress(*arguments, session, ranks); });
  });
}

}  // namespace lucerna::cli
