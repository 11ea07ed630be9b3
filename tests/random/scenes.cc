#include "scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <random>
#include <set>
#include <sstream>

namespace slipstick::random
{
  namespace
  {
    std::string text(const double value)
    {
      char buffer[40];
      std::snprintf(buffer, sizeof(buffer), "%.15g", value);
      return buffer;
    }

    /// The same numbers with every library.
    class Random
    {
    public:
      explicit Random(const unsigned int seed)
        : engine(7919u * seed + 12345u)
      {
        engine.discard(20);
      }
      double uniform(const double low, const double high)
      {
        return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
      }
      double power(const double low, const double high) // of ten
      {
        return std::pow(10., uniform(low, high));
      }
      int integer(const int low, const int high) // both included
      {
        return low + static_cast<int>(engine() % static_cast<std::uint64_t>(high - low + 1));
      }
      bool chance(const double probability)
      {
        return uniform(0, 1) < probability;
      }
      template <typename T>
      T pick(const std::vector<T> &list)
      {
        return list[integer(0, list.size() - 1)];
      }

    private:
      std::mt19937_64 engine;
    };

    /// A rectangle of triangles, or of triangles beside quadrilaterals, with its inner nodes moved; Gmsh 2.2.
    std::string mesh_of_rectangle(Random      &random,
                                  const double x0,
                                  const double y0,
                                  const double w,
                                  const double h,
                                  const int    nx,
                                  const int    ny,
                                  const bool   is_mixed)
    {
      std::ostringstream out;
      out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n1 1 \"left\"\n1 2 \"right\"\n1 3 \"bottom\"\n"
             "1 4 \"top\"\n2 5 \"body\"\n$EndPhysicalNames\n$Nodes\n"
          << (nx + 1) * (ny + 1) << "\n";
      const auto node = [nx](const int i, const int j) { return 1 + i + (nx + 1) * j; };
      for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i)
          {
            const bool   is_inside = i > 0 && i < nx && j > 0 && j < ny;
            const double dx = is_inside ? random.uniform(-.2, .2) : 0, dy = is_inside ? random.uniform(-.2, .2) : 0;
            out << node(i, j) << " " << text(x0 + w * (i + dx) / nx) << " " << text(y0 + h * (j + dy) / ny) << " 0\n";
          }
      std::vector<std::string> elements;
      for (int i = 0; i < nx; ++i)
        for (const auto &[tag, j] : {std::pair<int, int>{3, 0}, std::pair<int, int>{4, ny}})
          elements.push_back("1 2 " + std::to_string(tag) + " " + std::to_string(tag) + " " +
                             std::to_string(node(i, j)) + " " + std::to_string(node(i + 1, j)));
      for (int j = 0; j < ny; ++j)
        for (const auto &[tag, i] : {std::pair<int, int>{1, 0}, std::pair<int, int>{2, nx}})
          elements.push_back("1 2 " + std::to_string(tag) + " " + std::to_string(tag) + " " +
                             std::to_string(node(i, j)) + " " + std::to_string(node(i, j + 1)));
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i)
          {
            const std::array<int, 4> c    = {{node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)}};
            const auto               cell = [&](const int type, const std::vector<int> &corners) {
              std::string element = std::to_string(type) + " 2 5 5";
              for (const int k : corners)
                element += " " + std::to_string(c[k]);
              elements.push_back(element);
            };
            if (is_mixed && 2 * i < nx)
              cell(3, {0, 1, 2, 3});
            else if (random.chance(.5))
              {
                cell(2, {0, 1, 2});
                cell(2, {0, 2, 3});
              }
            else
              {
                cell(2, {0, 1, 3});
                cell(2, {1, 2, 3});
              }
          }
      out << "$EndNodes\n$Elements\n" << elements.size() << "\n";
      for (unsigned int e = 0; e < elements.size(); ++e)
        out << e + 1 << " " << elements[e] << "\n";
      out << "$EndElements\n";
      return out.str();
    }

    /// The .prm under construction. Lengths, stresses and so on are given in mm and MPa and written in the scene's units.
    class Builder
    {
    public:
      explicit Builder(const unsigned int seed)
        : random(seed)
        , seed_number(seed)
      {
        static const std::vector<std::array<double, 2>> units = {{{1, 1}},
                                                                 {{1e-3, 1e6}},
                                                                 {{1e3, 1e-6}},
                                                                 {{1 / 25.4, 145.}}};
        const auto                                      unit  = random.chance(.7) ? units[0] : random.pick(units);
        length_unit                                           = unit[0];
        stress_unit                                           = unit[1];
        degree                                                = random.chance(.3) ? 2 : 1;
        young                                                 = random.power(4, 5.5);
        has_ratio                                             = random.chance(.3);
        cell_size                                             = random.uniform(.8, 1.6) * (degree == 2 ? 1.6 : 1.);
        thickness                                             = random.chance(.7) ? 1. : random.uniform(.3, 30);
        pressure                                              = young * random.power(-4.5, -2.5);
        is_blocks                                             = false;
        law = random.pick<std::string>({"frictionless", "Tresca", "Coulomb", "Coulomb", "bonded", "mixed", "mixed"});
        top("Plane state", random.chance(.5) ? "plane stress" : "plane strain");
      }

      std::string length(const double value) const
      {
        return text(value * length_unit);
      }
      std::string stress(const double value) const
      {
        return text(value * stress_unit);
      }
      std::string point(const double x, const double y) const
      {
        return length(x) + ", " + length(y);
      }

      void top(const std::string &name, const std::string &value)
      {
        head << "set " << name << " = " << value << "\n";
      }

      /// A named subsection and its list.
      void add(const std::string                                      &list,
               const std::string                                      &kind,
               const std::string                                      &name,
               const std::vector<std::pair<std::string, std::string>> &values)
      {
        lists[list].push_back(name);
        section(kind + " " + name, values);
      }

      void section(const std::string &name, const std::vector<std::pair<std::string, std::string>> &values)
      {
        sections << "subsection " << name << "\n";
        for (const auto &[key, value] : values)
          sections << "  set " << key << " = " << value << "\n";
        sections << "end\n";
      }

      std::string material()
      {
        const std::string name  = "m" + std::to_string(lists["Materials"].size());
        const double      ratio = has_ratio ? random.power(-3, 3) : random.uniform(.5, 2);
        least_young             = std::min(least_young, young * ratio);
        add("Materials",
            "Material",
            name,
            {{"Young modulus", stress(young * ratio)},
             {"Poisson ratio", text(random.uniform(0, .45))},
             {"Thermal expansion", "1e-5"}});
        return name;
      }

      int cells(const double edge)
      {
        return std::clamp(static_cast<int>(std::lround(edge / cell_size * random.uniform(.8, 1.4))), 1, 8);
      }

      /// A rectangle with boundaries left, right, bottom, top. nx, ny: cells, 0 for any.
      std::string block(const double x0, const double y0, const double w, const double h, int nx = 0, int ny = 0)
      {
        const std::string name = "b" + std::to_string(lists["Bodies"].size());
        nx                     = nx > 0 ? nx : cells(w);
        ny                     = ny > 0 ? ny : cells(h);
        n_cells += nx * ny;
        if (random.chance(.25))
          {
            const std::string file     = "mesh_" + std::to_string(seed_number) + "_" + name + ".msh";
            const bool        is_mixed = nx > 1 && random.chance(.25);
            scene.meshes.emplace_back(file,
                                      mesh_of_rectangle(random,
                                                        x0 * length_unit,
                                                        y0 * length_unit,
                                                        w * length_unit,
                                                        h * length_unit,
                                                        nx,
                                                        ny,
                                                        is_mixed));
            add("Bodies",
                "Body",
                name,
                {{"Shape", "mesh"}, {"File", file}, {"Material", material()}, {"Thickness", length(thickness)}});
          }
        else
          add("Bodies",
              "Body",
              name,
              {{"Shape", "rectangle"},
               {"Origin", point(x0, y0)},
               {"Size", point(w, h)},
               {"Cells", std::to_string(nx) + ", " + std::to_string(ny)},
               {"Material", material()},
               {"Thickness", length(thickness)}});
        return name;
      }

      std::string round(const std::string &shape,
                        const double       x,
                        const double       y,
                        const double       radius,
                        const double       inner,
                        const int          n)
      {
        const std::string name = "b" + std::to_string(lists["Bodies"].size());
        n_cells += 2 * n;
        std::vector<std::pair<std::string, std::string>> values = {{"Shape", shape},
                                                                   {"Center", point(x, y)},
                                                                   {"Radius", length(radius)},
                                                                   {"Material", material()},
                                                                   {"Thickness", length(thickness)}};
        if (inner > 0)
          {
            values.emplace_back("Inner radius", length(inner));
            values.emplace_back("Cells", std::to_string(n) + ", " + std::to_string(random.integer(1, 2)));
          }
        else
          values.emplace_back("Cells along arc", std::to_string(n));
        add("Bodies", "Body", name, values);
        return name;
      }

      void support(const std::string &boundary, const std::string &x, const std::string &y)
      {
        std::vector<std::pair<std::string, std::string>> values = {{"Boundary", boundary}};
        if (!x.empty())
          values.emplace_back("Displacement x", x);
        if (!y.empty())
          values.emplace_back("Displacement y", y);
        add("Supports", "Support", "s" + std::to_string(lists["Supports"].size()), values);
      }

      void traction(const std::string &boundary, const double x, const double y)
      {
        add("Tractions",
            "Traction",
            "t" + std::to_string(lists["Tractions"].size()),
            {{"Boundary", boundary}, {"Traction x", stress(x)}, {"Traction y", stress(y)}});
      }

      /// A load that grows along x, in the middle of size p.
      void uneven_traction(const std::string &boundary,
                           const double       x,
                           const double       y,
                           const double       slope,
                           const double       middle)
      {
        const std::string form = "*(1+" + text(slope / length_unit) + "*(x-" + length(middle) + "))";
        add("Tractions",
            "Traction",
            "t" + std::to_string(lists["Tractions"].size()),
            {{"Boundary", boundary}, {"Traction x", stress(x) + form}, {"Traction y", stress(y) + form}});
      }

      void weight(const double x, const double y)
      {
        add("Body forces",
            "Body force",
            "weight",
            {{"Bodies", "all"},
             {"Force x", text(x * stress_unit / length_unit)},
             {"Force y", text(y * stress_unit / length_unit)}});
      }

      std::string half_plane(const double x, const double y, const double nx, const double ny)
      {
        const std::string name = "o" + std::to_string(lists["Obstacles"].size());
        add("Obstacles",
            "Obstacle",
            name,
            {{"Shape", "half plane"}, {"Point", point(x, y)}, {"Normal", text(nx) + ", " + text(ny)}});
        return name;
      }

      std::string circle(const std::string &shape, const double x, const double y, const double radius)
      {
        const std::string name = "o" + std::to_string(lists["Obstacles"].size());
        add("Obstacles", "Obstacle", name, {{"Shape", shape}, {"Center", point(x, y)}, {"Radius", length(radius)}});
        return name;
      }

      /// A gap or overlap like the deformation, or none.
      double offset(const double size)
      {
        const double typical = std::min(pressure / least_young, 1e-2) * size;
        switch (random.integer(0, 5))
          {
            case 0:
              return typical * random.uniform(0, 1);
            case 1:
              return -typical * random.uniform(0, 1);
            case 2:
              return -typical * 1e-6;
            default:
              return 0;
          }
      }

      /// Contact by the law of the scene; @p can_bond: between bodies.
      void contact(const std::string &slave, const std::string &master, const double gap, const bool can_bond = true)
      {
        std::string one = law;
        if (one == "mixed")
          one = random.pick<std::string>({"frictionless", "Tresca", "Coulomb", "bonded"});
        if (one == "bonded" && !can_bond)
          one = random.pick<std::string>({"frictionless", "Tresca", "Coulomb"});
        laws.insert(one);
        std::vector<std::pair<std::string, std::string>> values = {{"Slave", slave}, {"Master", master}, {"Law", one}};
        if (one == "Tresca")
          values.emplace_back("Slip bound",
                              stress(random.chance(.1)   ? 0.
                                     : random.chance(.1) ? 1e3 * pressure
                                                         : pressure * random.uniform(0, .8)));
        if (one == "Coulomb")
          values.emplace_back("Friction coefficient",
                              text(random.chance(.08)  ? 0.
                                   : random.chance(.5) ? random.uniform(.05, .6)
                                                       : random.uniform(.3, 2)));
        if (one != "bonded" && gap != 0)
          values.emplace_back("Offset", length(gap));
        if (random.chance(.15))
          values.emplace_back("Discretization", can_bond ? "mortar" : "auto");
        add("Contacts", "Contact", "c" + std::to_string(lists["Contacts"].size()), values);
      }

      GeneratedScene finished()
      {
        const int n_bodies = lists["Bodies"].size();
        for (const auto &[list, names] : lists)
          {
            std::string all;
            for (const auto &name : names)
              all += (all.empty() ? "" : ", ") + name;
            top(list, all);
          }
        section("Discretization", {{"Degree", std::to_string(degree)}});
        section("Friction", {{"Max iterations", "500"}});
        scene.prm        = head.str() + sections.str();
        const auto metis = [&](const int n) {
          return std::vector<std::string>{"Decomposition/Method=METIS",
                                          "Decomposition/Subdomains=" + std::to_string(std::min(n, n_cells)),
                                          "Decomposition/Seed=" + std::to_string(random.integer(0, 9))};
        };
        if (random.chance(.3))
          scene.decompositions.push_back({"Decomposition/Method=none"});
        else
          scene.decompositions.push_back(metis(n_bodies + random.integer(0, 2)));
        scene.decompositions.push_back(metis(n_bodies * random.integer(2, 3) + random.integer(0, 4)));
        scene.law = laws.size() == 1 ? *laws.begin() : "mixed";
        return scene;
      }

      Random         random;
      unsigned int   seed_number;
      GeneratedScene scene;
      double         length_unit, stress_unit, young, cell_size, thickness, pressure;
      double         least_young = 1e300;
      int            degree, n_cells = 0;
      bool           has_ratio, is_blocks;
      std::string    law;

    private:
      std::ostringstream                              head, sections;
      std::map<std::string, std::vector<std::string>> lists;
      std::set<std::string>                           laws;
    };

    /// Sideways load against the pressing one: none, small, or enough to push things away now and then.
    double sideways(Builder &b)
    {
      return b.random.chance(.4) ? 0. : b.pressure * b.random.uniform(-.6, .6);
    }

    void press(Builder &b, const std::string &boundary, const double middle, const double width)
    {
      const double p = b.random.chance(.06) ? 0. : b.random.chance(.05) ? .3 * b.pressure : -b.pressure;
      if (b.random.chance(.6))
        b.traction(boundary, sideways(b), p);
      else
        b.uneven_traction(boundary, sideways(b), p, b.random.uniform(-.8, .8) / width, middle);
    }

    void foundation(Builder &b, const std::string &boundary)
    {
      const double unit = b.young * b.stress_unit / b.length_unit;
      b.add("Foundations",
            "Foundation",
            "f",
            {{"Boundary", boundary},
             {"Normal stiffness", text(unit * b.random.uniform(.01, .05))},
             {"Tangential stiffness", text(b.random.chance(.3) ? 0. : unit * b.random.uniform(0, .01))}});
    }

    void one_on_obstacle(Builder &b)
    {
      Random      &r = b.random;
      const double w = r.uniform(3, 9), h = r.uniform(2, 6);
      std::string  body, slave;
      const int    shape = r.integer(0, 5);
      if (shape <= 2)
        {
          body  = b.block(0, 0, w, h);
          slave = body + "/bottom";
        }
      else if (shape == 3)
        {
          body  = b.round("half disc", w / 2, w / 2, w / 2, 0, 2 * r.integer(3, 7));
          slave = body + "/arc";
        }
      else if (shape == 4)
        {
          body  = b.round("disc", w / 2, w / 2, w / 2, 0, 4 * r.integer(3, 5));
          slave = body + "/arc";
        }
      else
        {
          body  = b.round("ring", w / 2, w / 2, w / 2, w * r.uniform(.15, .35), 4 * r.integer(3, 5));
          slave = body + "/outer";
        }
      std::string obstacle;
      switch (r.integer(0, 3))
        {
          case 0:
            obstacle = b.half_plane(0, 0, 0, 1);
            break;
          case 1:
            {
              const double radius = r.uniform(5, 30);
              obstacle            = b.circle("circle", r.chance(.5) ? w / 2 : w * r.uniform(.2, .8), -radius, radius);
              break;
            }
          case 2:
            obstacle = "o0";
            b.add("Obstacles",
                  "Obstacle",
                  obstacle,
                  {{"Shape", "function"},
                   {"Height", b.length(-.003 * w) + "*(1-cos(" + text(3 / w / b.length_unit) + "*x))"}});
            break;
          default:
            obstacle = "o0";
            b.add("Obstacles",
                  "Obstacle",
                  obstacle,
                  {{"Shape", "polyline"},
                   {"Points",
                    b.length(-2 * w) + " " + b.length(r.uniform(-.5, .5)) + "; " + b.length(w * r.uniform(.2, .8)) +
                      " 0; " + b.length(3 * w) + " " + b.length(r.uniform(-.5, .5))}});
        }
      b.contact(slave, obstacle, b.offset(h), false);
      const int         hold   = r.integer(0, 4); // 0, 1: floating
      const std::string loaded = shape <= 2 ? body + "/top" : shape == 3 ? body + "/flat" : "";
      if (hold >= 2 && shape <= 2)
        {
          if (hold == 2)
            b.support(body + "/left", "0", "0");
          else if (hold == 3)
            b.support(body + "/left", "0", "");
          else
            b.support(body + "/top",
                      r.chance(.5) ? "0" : b.length(r.uniform(-.01, .01)),
                      b.length(-r.uniform(0, 2e-3) * h));
        }
      else if (hold >= 3 && shape == 3)
        b.support(loaded, "0", r.chance(.5) ? "" : b.length(-r.uniform(0, 2e-3) * w));
      if (shape <= 3 && hold != 4)
        press(b, loaded, w / 2, w);
      else if (shape > 3)
        {
          b.weight(r.chance(.5) ? 0 : r.uniform(-.5, .5) * b.pressure / w, -b.pressure / w);
          if (hold >= 2)
            foundation(b, body + (shape == 4 ? "/arc" : "/inner"));
        }
      if (r.chance(.2) && shape <= 2)
        b.traction(body + "/right", sideways(b), 0);
    }

    void two_bodies(Builder &b)
    {
      Random      &r  = b.random;
      const double w1 = r.uniform(4, 9), h1 = r.uniform(2, 4), w2 = r.chance(.3) ? w1 : r.uniform(2, 9),
                   h2      = r.uniform(2, 4);
      const double x2      = w1 == w2 ? 0. : r.uniform(-.3 * w2, w1 - .7 * w2);
      const bool   matches = w1 == w2 && r.chance(.7);
      const int    n       = matches ? b.cells(w1) : 0;
      const auto   lower   = b.block(0, 0, w1, h1, n);
      const int    shape   = r.integer(0, 3);
      std::string  upper, slave, loaded;
      if (shape <= 2)
        {
          upper  = b.block(x2, h1, w2, h2, n);
          slave  = upper + "/bottom";
          loaded = upper + "/top";
        }
      else
        {
          upper  = b.round("half disc", w1 / 2, h1 + w2 / 2, w2 / 2, 0, 2 * r.integer(3, 7));
          slave  = upper + "/arc";
          loaded = upper + "/flat";
        }
      if (r.chance(.5) || shape == 3)
        b.contact(slave, lower + "/top", b.offset(h1 + h2));
      else
        b.contact(lower + "/top", slave, b.offset(h1 + h2));
      if (r.chance(.6))
        b.support(lower + "/bottom", "0", "0");
      else
        {
          b.support(lower + "/bottom", "", "0");
          b.support(lower + "/left", "0", "");
        }
      switch (r.integer(0, 3))
        {
          case 0:
            if (shape <= 2)
              b.support(upper + "/left", "0", "");
            else
              b.support(loaded, "0", "");
            break;
          case 1:
            b.support(loaded,
                      r.chance(.5) ? "0" : b.length(r.uniform(-5e-3, 5e-3)),
                      b.length(-r.uniform(0, 4e-3) * h2));
            break;
          default:;
        }
      if (r.chance(.85))
        press(b, loaded, shape <= 2 ? x2 + w2 / 2 : w1 / 2, w2);
      if (r.chance(.15))
        b.add("Temperatures", "Temperature", "heat", {{"Bodies", lower}, {"Change", text(r.uniform(-100, 100))}});
    }

    void stack(Builder &b)
    {
      Random     &r = b.random;
      const int   n = r.integer(3, 6);
      double      y = 0, middle = 0, width = r.uniform(4, 7);
      std::string below;
      b.cell_size *= 1.2;
      const bool matches = r.chance(.3);
      const int  nx      = matches ? b.cells(width) : 0;
      for (int k = 0; k < n; ++k)
        {
          const double h    = r.uniform(1, 2.5);
          const auto   body = b.block(middle - width / 2, y, width, h, nx);
          if (k == 0)
            {
              if (r.chance(.75))
                b.support(body + "/bottom", "0", "0");
              else
                b.contact(body + "/bottom", b.half_plane(0, 0, 0, 1), b.offset(h), false);
            }
          else if (r.chance(.6))
            b.contact(body + "/bottom", below + "/top", b.offset(h));
          else
            b.contact(below + "/top", body + "/bottom", b.offset(h));
          if (k > 0 && r.chance(.15))
            b.support(body + "/left", "0", "");
          if (k > 0 && r.chance(.15))
            b.traction(body + "/right", .3 * sideways(b), 0);
          y += h;
          below = body;
          if (k + 1 == n)
            press(b, body + "/top", middle, width);
          if (!matches)
            {
              middle += r.uniform(-.15, .15) * width;
              width *= r.uniform(.7, 1.2);
            }
        }
      if (r.chance(.3))
        b.weight(0, -.1 * b.pressure);
    }

    void wall(Builder &b)
    {
      Random      &r = b.random;
      const double h = r.uniform(1.5, 3), w = r.uniform(2.5, 5), gap = r.chance(.5) ? 0. : 1e-3 * w * r.uniform(0, 1);
      b.cell_size *= 1.2;
      const auto left = b.block(0, 0, w, h), right = b.block(w + gap, 0, w, h);
      const auto upper = b.block(w * r.uniform(.2, .5), h, w * r.uniform(1., 1.4), h);
      if (r.chance(.5))
        {
          b.support(left + "/bottom", "0", "0");
          b.support(right + "/bottom", "0", "0");
        }
      else
        {
          const auto floor = b.half_plane(0, 0, 0, 1);
          b.contact(left + "/bottom", floor, 0, false);
          b.contact(right + "/bottom", floor, b.offset(h), false);
          if (r.chance(.5))
            b.support(left + "/left", "0", "");
        }
      b.contact(left + "/right", right + "/left", 0);
      b.contact(upper + "/bottom", left + "/top", b.offset(h));
      b.contact(upper + "/bottom", right + "/top", b.offset(h));
      press(b, upper + "/top", w, w);
      if (r.chance(.5))
        {
          const auto top = b.block(w * .3, 2 * h, w, h);
          b.contact(top + "/bottom", upper + "/top", 0);
          if (r.chance(.6))
            b.weight(0, -.2 * b.pressure);
          b.traction(top + "/top", .2 * sideways(b), -b.pressure);
        }
      else if (r.chance(.5))
        b.traction(right + "/right", -std::abs(sideways(b)), 0);
    }

    void fit(Builder &b)
    {
      Random      &r      = b.random;
      const double radius = r.uniform(2, 4), outer = radius * r.uniform(1.4, 2);
      const int    n       = 4 * r.integer(3, 4);
      const bool   is_disc = r.chance(.5);
      const auto   ring    = b.round("ring", 0, 0, outer, radius, r.chance(.4) ? n : 4 * r.integer(3, 5));
      const auto core = b.round(is_disc ? "disc" : "ring", 0, 0, radius, is_disc ? 0. : radius * r.uniform(.3, .6), n);
      const double overlap = -std::min(b.pressure / b.least_young, 1e-2) * radius * r.uniform(-.1, 1);
      b.contact(core + (is_disc ? "/arc" : "/outer"), ring + "/inner", overlap);
      if (r.chance(.6))
        b.support(ring + "/outer", "0", "0");
      else
        foundation(b, ring + "/outer");
      b.weight(r.uniform(-.2, .2) * b.pressure / radius, -r.uniform(0, .5) * b.pressure / radius);
    }

    void roller(Builder &b)
    {
      Random      &r      = b.random;
      const double radius = r.uniform(1, 2), w = r.uniform(3, 6), h = r.uniform(1.5, 3);
      const auto   lower = b.block(-w / 2, -h, w, h);
      const auto   upper = b.block(-w / 2, 2 * radius, w, h);
      b.support(lower + "/bottom", "0", "0");
      const int    n     = r.integer(1, 2); // rollers
      const double apart = n == 1 ? 0. : 1.2 * radius;
      for (int k = 0; k < n; ++k)
        {
          const auto disc = b.round("disc",
                                    n == 1 ? r.uniform(-.2, .2) * w : (2 * k - 1) * apart,
                                    radius,
                                    radius,
                                    0,
                                    4 * r.integer(3, 4));
          b.contact(disc + "/arc", lower + "/top", b.offset(radius));
          if (r.chance(.7))
            b.contact(disc + "/arc", upper + "/bottom", b.offset(radius));
          else
            b.contact(upper + "/bottom", disc + "/arc", b.offset(radius));
        }
      switch (r.integer(0, 2))
        {
          case 0:
            b.support(upper + "/top", b.length(r.uniform(-1e-3, 1e-3)), b.length(-r.uniform(1e-4, 2e-3) * radius));
            break;
          case 1:
            b.support(upper + "/left", "0", "");
            press(b, upper + "/top", 0, w);
            break;
          default:
            b.support(upper + "/right", "0", r.chance(.5) ? "0" : "");
            press(b, upper + "/top", 0, w);
        }
      if (r.chance(.4))
        b.weight(0, -.05 * b.pressure);
    }

    /// One body between two obstacles, or in a round hole.
    void groove(Builder &b)
    {
      Random      &r = b.random;
      const double w = r.uniform(2, 5), slope = r.uniform(.3, 1.2);
      if (r.chance(.5))
        {
          const bool is_disc = r.chance(.5);
          const auto body    = is_disc
                                 ? b.round("disc", 0, w / std::cos(slope), w, 0, 4 * r.integer(3, 5))
                                 : b.round("ring", 0, w / std::cos(slope), w, w * r.uniform(.4, .7), 4 * r.integer(3, 5));
          const auto arc     = body + (is_disc ? "/arc" : "/outer");
          b.contact(arc, b.half_plane(0, 0, -std::sin(slope), std::cos(slope)), b.offset(w), false);
          const double other = r.chance(.5) ? slope : r.uniform(.8, 1.) * slope;
          b.contact(arc, b.half_plane(0, 0, std::sin(other), std::cos(other)), b.offset(w), false);
          b.weight(r.chance(.5) ? 0. : r.uniform(-.3, .3) * b.pressure / w, -b.pressure / w);
        }
      else if (r.chance(.5))
        {
          const auto body = b.block(0, 0, w, r.uniform(2, 4));
          b.contact(body + "/bottom", b.half_plane(0, 0, 0, 1), b.offset(w), false);
          b.contact(body + "/left", b.half_plane(0, 0, 1, 0), b.offset(w), false);
          press(b, body + "/top", w / 2, w);
          b.traction(body + "/right", r.chance(.8) ? -std::abs(sideways(b)) : sideways(b), sideways(b) * .3);
        }
      else
        {
          const bool is_disc = r.chance(.5);
          const auto body =
            b.round(is_disc ? "disc" : "half disc", 0, 0, w, 0, is_disc ? 4 * r.integer(3, 5) : 2 * r.integer(4, 7));
          const double hole = w * r.uniform(1.02, 1.3);
          b.contact(body + "/arc", b.circle("hole", 0, hole - w, hole), b.offset(w), false);
          b.weight(r.uniform(-.3, .3) * b.pressure / w, -b.pressure / w);
          if (!is_disc && r.chance(.7))
            press(b, body + "/flat", 0, w);
        }
    }
  } // namespace

  GeneratedScene generate(const unsigned int seed)
  {
    static const std::vector<std::pair<std::string, void (*)(Builder &)>> families = {{"obstacle", one_on_obstacle},
                                                                                      {"two", two_bodies},
                                                                                      {"stack", stack},
                                                                                      {"wall", wall},
                                                                                      {"fit", fit},
                                                                                      {"roller", roller},
                                                                                      {"groove", groove}};
    static const std::vector<unsigned int> order  = {0, 1, 2, 3, 1, 4, 5, 0, 2, 6}; // how often each comes
    const auto                            &family = families[order[seed % order.size()]];
    Builder                                builder(seed);
    family.second(builder);
    builder.scene.family = family.first;
    return builder.finished();
  }
} // namespace slipstick::random
