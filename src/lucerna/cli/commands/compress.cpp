// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/output/compress_output.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/cli/parse/compress_arguments.h"

namespace lucerna::cli {

namespace {

void run_compress(const CompressArguments& a, Session& session) {
  session.start();
  const CompressOptions options = compress_options(a);
  check_compress(a);
  const CompressedFiles made =
      session.timed("compress", [&] { return compress(a.files(), options, session.progress()); });
  write_compress_output(a, made, session);
}

}  // namespace

void add_compress(CLI::App& app, Session& session, int&) {
  Command command(app, "compress", "Make a small source model of ray files");
  auto arguments = std::make_shared<CompressArguments>();
  add_compress_options(command, *arguments, session);
  command.on_run([arguments, &session] { run_compress(*arguments, session); });
}

}  // namespace lucerna::cli
