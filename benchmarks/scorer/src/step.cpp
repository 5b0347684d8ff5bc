// SPDX-License-Identifier: Apache-2.0
#include "surface.h"

#ifdef BENCH_OPENCASCADE

#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Plane.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <mutex>
#include <set>

#include "patch.h"

namespace bench {

namespace {

constexpr std::size_t kMaxFaces = 10'000;
/// Of a surface without knots.
constexpr int kPieces = 8;

Vec3 vec(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

TopoDS_Shape read_shape(const std::string& file) {
  // It would write its progress between the lines of a score.
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  STEPControl_Reader reader;
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone)
    throw InputError(file, "file", "nothing that OpenCASCADE reads", "a STEP file");
  reader.TransferRoots();
  if (reader.NbShapes() == 0) throw InputError(file, "file", "no shape", "one or more faces");
  return reader.OneShape();
}

/// A face: its surface between the bounds of its parameters; OpenCASCADE says what lies within its wires.
class FacePatch final : public Patch {
 public:
  explicit FacePatch(const TopoDS_Face& face)
      : surface_(BRep_Tool::Surface(face)),
        reversed_(face.Orientation() == TopAbs_REVERSED),
        within_(face, Precision::PConfusion()) {
    BRepTools::UVBounds(face, low_[0], high_[0], low_[1], high_[1]);
  }
  SurfaceJet jet(double& u, double& v) const override {
    // What goes round may be left on one side and entered on the other.
    if (!surface_->IsUPeriodic()) u = std::clamp(u, low_[0], high_[0]);
    if (!surface_->IsVPeriodic()) v = std::clamp(v, low_[1], high_[1]);
    gp_Pnt p;
    gp_Vec by_u, by_v;
    surface_->D1(u, v, p, by_u, by_v);
    return {vec(p.XYZ()), vec(by_u.XYZ()), vec(by_v.XYZ())};
  }
  std::vector<double> breaks(std::size_t axis) const override {
    const double low = low_[axis], high = high_[axis];
    std::set<double> at{low, high};
    const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface_);
    const int count = spline.IsNull() ? 0 : axis == 0 ? spline->NbUKnots() : spline->NbVKnots();
    for (int k = 1; k <= count; ++k) {
      const double knot = axis == 0 ? spline->UKnot(k) : spline->VKnot(k);
      if (knot > low && knot < high) at.insert(knot);
    }
    for (int k = 1; count == 0 && k < kPieces; ++k) at.insert(low + (high - low) * k / kPieces);
    return {at.begin(), at.end()};
  }
  bool straight(std::size_t) const override { return !Handle(Geom_Plane)::DownCast(surface_).IsNull(); }
  bool trimmed() const override { return true; }
  bool keeps(double u, double v, const Vec3&) const override {
    // It keeps its place in a list of wires, so it is no function for two threads at once.
    const std::lock_guard lock(guard_);
    return within_.Perform(gp_Pnt2d(u, v)) != TopAbs_OUT;
  }
  double side() const override { return reversed_ ? -1.0 : 1.0; }

 private:
  Handle(Geom_Surface) surface_;
  bool reversed_;
  mutable std::mutex guard_;
  BRepTopAdaptor_FClass2d within_;
  std::array<double, 2> low_{}, high_{};
};

std::vector<std::unique_ptr<Surface>> faces_of(const std::string& file, const Frame& place) {
  std::vector<std::unique_ptr<Surface>> out;
  for (TopExp_Explorer at(read_shape(file), TopAbs_FACE); at.More(); at.Next()) {
    const std::string name = "face " + std::to_string(out.size() + 1);
    if (out.size() == kMaxFaces)
      throw InputError(file, name, "more faces", "no more than " + std::to_string(kMaxFaces));
    auto patch = std::make_unique<FacePatch>(TopoDS::Face(at.Current()));
    if (patch->breaks(0).size() * patch->breaks(1).size() > kMaxQuads)
      throw InputError(file, name, "too many pieces", "at most " + std::to_string(kMaxQuads));
    out.push_back(surface_of(std::move(patch), place));
  }
  if (out.empty()) throw InputError(file, "file", "no face", "one or more");
  return out;
}

}  // namespace

std::vector<std::unique_ptr<Surface>> read_step(const std::string& file, const Frame& place) {
  try {
    return faces_of(file, place);
  } catch (const Standard_Failure& e) {
    throw InputError(file, "file", std::string("what OpenCASCADE calls ") + e.GetMessageString(),
                     "a STEP file");
  }
}

}  // namespace bench

#else

namespace bench {

std::vector<std::unique_ptr<Surface>> read_step(const std::string& file, const Frame&) {
  throw InputError(file, "file", "a STEP file",
                   "an STL file or a B-spline: this scorer was built without OpenCASCADE");
}

}  // namespace bench

#endif
