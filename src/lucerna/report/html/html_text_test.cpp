// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/html_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/error.h"
#include "lucerna/results/svg/html_escaped.h"

namespace lucerna {
namespace {

TEST(HtmlText, NothingOfTheDataBecomesMarkup) {
  EXPECT_EQ(html_escaped("<b a=\"1\">&\x01</b>"), "&lt;b a=&quot;1&quot;&gt;&amp;&lt;/b&gt;");
  const std::string element = data_element("d", {{"x", "</script><script>alert(1)</script>"}});
  EXPECT_EQ(element.find("</script>"), element.rfind("</script>"));
  EXPECT_NE(element.find("\\u003c/script>"), std::string::npos);
}

TEST(HtmlText, FloatsAreLittleEndianBase64) {
  // 1.0f is 00 00 80 3f, -2.5f is 00 00 20 c0.
  EXPECT_EQ(base64_floats(std::vector<double>{1.0}), "AACAPw==");
  EXPECT_EQ(base64_floats(std::vector<double>{1.0, -2.5}), "AACAPwAAIMA=");
  EXPECT_EQ(base64_floats(std::vector<double>{}), "");
  EXPECT_EQ(base64_floats(std::vector<double>{1.0, 1.0, 1.0}).size(), 16u);
}

TEST(HtmlText, InlinePicturesShareNoIds) {
  const std::string svg = "<svg width=\"1\"><clipPath id=\"clip0\"/><g clip-path=\"url(#clip0)\"/></svg>";
  EXPECT_EQ(inline_svg(svg, "p-", "A \"plot\""),
            "<svg role=\"img\" aria-label=\"A &quot;plot&quot;\" width=\"1\"><clipPath id=\"p-clip0\"/>"
            "<g clip-path=\"url(#p-clip0)\"/></svg>");
  EXPECT_THROW(inline_svg("<p>", "p-", ""), InputError);
}

}  // namespace
}  // namespace lucerna
