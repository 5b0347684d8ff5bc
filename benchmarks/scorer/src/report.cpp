// SPDX-License-Identifier: Apache-2.0
#include "report.h"

#include <cstdio>
#include <fstream>
#include <thread>

namespace bench {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Estimate& e) { return {{"value", e.mean}, {"standard_error", e.standard_error}}; }
Json json_of(const BoxError& e) {
  return {{"excess", e.excess},
          {"standard_error", e.standard_error},
          {"floor", e.floor},
          {"value", e.value},
          {"scale", e.scale}};
}

Json stated_json(const Stated& s) {
  Json out{{"free_parameters", s.free_parameters}, {"wall_s", s.wall_s}};
  out["cpu_s"] = s.cpu_s ? Json(*s.cpu_s) : Json();
  out["machine"] = s.machine;
  out["program"] = s.program;
  out["method"] = s.method;
  return out;
}

Json limits_json(const std::vector<LimitCheck>& limits) {
  Json out = Json::array();
  for (const LimitCheck& c : limits)
    out.push_back({{"limit", c.limit}, {"found", c.found}, {"allowed", c.allowed}, {"held", c.held}});
  return out;
}

Json road_json(const RoadScore& s, const std::vector<LimitCheck>& limits) {
  return {{"lm_per_cd_m2", json_of(s.lm_per_cd_m2)},
          {"overall_uniformity", json_of(s.overall)},
          {"lengthwise_uniformity", json_of(s.lengthwise)},
          {"threshold_increment", json_of(s.threshold_increment)},
          {"limits", limits_json(limits)}};
}

Json balance_json(const Score& s) {
  return {{"mirrors", json_of(s.mirror)},        {"backs_of_mirrors", json_of(s.mirror_back)},
          {"absorbers", json_of(s.absorber)},    {"bulk", json_of(s.bulk)},
          {"interfaces", json_of(s.interface)},  {"source", json_of(s.source)},
          {"wrong_side", json_of(s.wrong_side)}, {"too_many_hits", json_of(s.too_many_hits)}};
}

template <class... T>
std::string line(const char* format, T... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return std::string(text) + "\n";
}

std::string error_line(const char* name, const Json& e) {
  return line("  %-28s %9.4f +- %.4f %%   (with noise %.4f %%, noise %.4f %%)", name,
              100.0 * e["excess"].get<double>(), 100.0 * e["standard_error"].get<double>(),
              100.0 * e["value"].get<double>(), 100.0 * e["floor"].get<double>());
}
std::string share_line(const char* name, const Json& e) {
  return line("  %-28s %9.4f +- %.4f %%", name, 100.0 * e["value"].get<double>(),
              100.0 * e["standard_error"].get<double>());
}

std::string errors_text(const Json& s) {
  std::string out = error_line("error, 12 boxes a side", s["error_12"]) +
                    error_line("error, 24 boxes a side", s["error_24"]) +
                    error_line("error, 48 boxes a side", s["error_48"]);
  out += share_line("worst box, of the peak", s["worst_box"]);
  out += line("  %-28s %9.4f %%   (of a perfect optic by noise: %.4f %%)", "NMAE",
              100.0 * s["nmae"]["value"].get<double>(), 100.0 * s["nmae"]["noise"].get<double>());
  if (s["rsd"].is_null())
    return out + "  RSD                          no meaning: the target is not uniform\n";
  return out + line("  %-28s %9.4f %%   (with noise %.4f %%)", "RSD", 100.0 * s["rsd"]["value"].get<double>(),
                    100.0 * s["rsd"]["with_noise"].get<double>());
}

std::string road_text(const Json& road) {
  const auto& lm = road["lm_per_cd_m2"];
  return line("  %-28s %9.1f +- %.1f lm", "of a lamp for 1 cd/m2", lm["value"].get<double>(),
              lm["standard_error"].get<double>()) +
         share_line("overall uniformity, Uo", road["overall_uniformity"]) +
         share_line("lengthwise uniformity, Ul", road["lengthwise_uniformity"]) +
         share_line("threshold increment, TI", road["threshold_increment"]);
}

std::string stated_text(const Json& s) {
  std::string out = line("  stated, not checked: %lld free parameters, %.6g s of wall time,",
                         s["free_parameters"].get<long long>(), s["wall_s"].get<double>());
  out += s["cpu_s"].is_null() ? line("    processor seconds: not stated")
                              : line("    processor seconds: %.6g", s["cpu_s"].get<double>());
  return out + "    " + s["machine"].get<std::string>() + "; " + s["program"].get<std::string>() + "; " +
         s["method"].get<std::string>() + "\n";
}

}  // namespace

Json score_json(const Task& task, const Submission& submission, const Target& target, const Score& s,
                const RunFacts& run) {
  Json out{{"format", "lucerna-bench-score"},
           {"version", 1},
           {"task", task.id},
           {"title", task.title},
           {"headline", task.headline},
           {"name", submission.name},
           {"author", submission.author}};
  const auto broken = faults(s, submission);
  out["counts"] = broken.empty();
  out["faults"] = broken;
  out["light_table"] = submission.light_table != nullptr;
  out["rays"] = s.rays;
  out["rays_from"] = run.rays_from;
  out["seed"] = run.seed;
  out["road"] = s.road ? road_json(*s.road, s.road_limits) : Json();
  const auto unless_road = [&](const Json& figure) { return s.road ? Json() : figure; };
  out["error_12"] = unless_road(json_of(s.n12));
  out["error_24"] = unless_road(json_of(s.n24));
  out["error_48"] = unless_road(json_of(s.n48));
  out["worst_box"] = unless_road(json_of(s.n48.worst));
  out["nmae"] = unless_road({{"value", s.nmae.value}, {"noise", s.nmae.noise}});
  out["rsd"] = s.rsd ? Json{{"value", s.rsd->without_noise}, {"with_noise", s.rsd->raw}} : Json();
  out["efficiency_with_losses"] = json_of(s.efficiency);
  out["efficiency_without_losses"] = json_of(s.efficiency_lossless);
  out["in_rectangle"] = unless_road(json_of(s.in_rectangle));
  out["outside_rectangle"] = unless_road(json_of(s.outside));
  out["outside_rectangle_direct"] = unless_road(json_of(s.outside_direct));
  out["absorbed"] = balance_json(s);
  out["rectangle"] = unless_road({{"low", target.low()}, {"high", target.high()}});
  out["limits"] = limits_json(submission.limits);
  out["stated"] = stated_json(submission.stated);
  out["run"] = {{"threads", run.threads}, {"seconds", run.seconds}, {"machine", run.machine}};
  return out;
}

std::string score_text(const Json& s) {
  std::string out = s["task"].get<std::string>() + ", " + s["title"].get<std::string>() + "\n  " +
                    s["name"].get<std::string>() + " (" + s["author"].get<std::string>() + ")\n";
  out += line("  %llu rays (%s, seed %llu)", s["rays"].get<unsigned long long>(),
              s["rays_from"].get<std::string>().c_str(), s["seed"].get<unsigned long long>());
  out += s["road"].is_null() ? errors_text(s) : road_text(s["road"]);
  out += share_line("efficiency, with losses", s["efficiency_with_losses"]);
  out += share_line("efficiency, without losses", s["efficiency_without_losses"]);
  if (s["road"].is_null()) {
    out += share_line("light in the rectangle", s["in_rectangle"]);
    out += share_line("light beside it", s["outside_rectangle"]);
    out += share_line("  of it, met no surface", s["outside_rectangle_direct"]);
  }
  for (const auto& [cause, share] : s["absorbed"].items()) {
    if (share["value"].get<double>() > 0.0) out += share_line(("taken by " + cause).c_str(), share);
  }
  out += stated_text(s["stated"]);
  out += line("  scored in %.1f s on %u threads, %s", s["run"]["seconds"].get<double>(),
              s["run"]["threads"].get<unsigned>(), s["run"]["machine"].get<std::string>().c_str());
  if (s["light_table"].get<bool>()) out += "  a light table: not traced, limits not checked\n";
  for (const Json& fault : s["faults"]) out += "  DOES NOT COUNT: " + fault.get<std::string>() + "\n";
  return out;
}

std::string boxes_csv(const Target& target, const Score& score) {
  std::string out = "u_low,u_high,v_low,v_high,measure,target,share,standard_error\n";
  const auto low = target.low(), high = target.high();
  const double su = (high[0] - low[0]) / kBoxes, sv = (high[1] - low[1]) / target.rows();
  std::vector<double> values(score.boxes.by_replicate.size());
  for (std::size_t b = 0; b < score.boxes.measure.size(); ++b) {
    for (std::size_t r = 0; r < values.size(); ++r) values[r] = score.boxes.by_replicate[r][b];
    const Estimate e = mean_of(values);
    const auto i = static_cast<double>(b % kBoxes), j = static_cast<double>(b / kBoxes);
    out += line("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", low[0] + i * su, low[0] + (i + 1) * su,
                low[1] + j * sv, low[1] + (j + 1) * sv, score.boxes.measure[b], score.boxes.target[b], e.mean,
                e.standard_error);
  }
  return out;
}

std::string machine_name() {
  std::ifstream cpus("/proc/cpuinfo");
  std::string text, name = "unknown processor";
  while (std::getline(cpus, text)) {
    if (text.rfind("model name", 0) != 0 || text.find(": ") == std::string::npos) continue;
    name = text.substr(text.find(": ") + 2);
    break;
  }
  return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads";
}

}  // namespace bench
