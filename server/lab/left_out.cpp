#include <map>

#include "server/lab/exports.h"
#include "server/scene/method.h"

namespace clothlab::lab {

std::vector<std::string> left_out(const Chart& chart) {
  std::vector<std::string> reasons;  // each once, in the order of the chart's list
  std::map<std::string, std::map<scene::Method, int>> points;
  for (const LeftOut& one : chart.left_out) {
    if (!points.contains(one.reason)) reasons.push_back(one.reason);
    ++points[one.reason][one.method];
  }
  std::vector<std::string> texts;
  for (const std::string& reason : reasons) {
    std::string methods;
    for (const auto& [method, count] : points[reason]) {
      methods += (methods.empty() ? "" : ", ") + std::string(scene::name(method));
      if (count > 1) methods += " (" + std::to_string(count) + " points)";
    }
    texts.push_back(methods + ": " + reason);
  }
  return texts;
}

}  // namespace clothlab::lab
