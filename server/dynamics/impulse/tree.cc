// How the rows of a tree are laid out.
#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {

void Tree::assign(std::vector<TreeNode> nodes) {
  nodes_ = std::move(nodes);
  rows_.clear();
  row_of_.clear();
  roots_.clear();
  for (std::size_t i = 0; i < size(); ++i) add_rows(i);
  find_ways();
  find_parts();
  factors_.assign(rows_.size(), {});
  asked_.assign(rows_.size(), {});
  answers_.assign(rows_.size(), {});
  loads_.assign(rows_.size(), {});
  way_.resize(rows_.size());
  on_way_.assign(places() * kMostTogether, 0.0);
}

void Tree::add_rows(std::size_t i) {
  const TreeNode& node = nodes_[i];
  TreeRow row;
  row.node = static_cast<int>(i);
  row.parent = node.parent < 0 ? -1 : static_cast<int>(row_of_[static_cast<std::size_t>(node.parent)]);
  row.root = node.joint < 0 ? static_cast<int>(roots_.size()) : -1;
  row.alone = node.freedoms == 1;
  if (row.root >= 0) roots_.emplace_back().row = rows_.size();
  // All free directions but the last have a row without a body; the last row carries the body.
  for (int axis = 0; axis + 1 < node.freedoms; ++axis) {
    row.axis = axis;
    rows_.push_back(row);
    row.parent = static_cast<int>(rows_.size()) - 1;
  }
  row.axis = node.freedoms - 1;
  row.body = node.body;
  row.mass = node.mass;
  row_of_.push_back(rows_.size());
  rows_.push_back(row);
}

void Tree::find_ways() {
  for (std::size_t i = rows_.size(); i-- > 0;) {
    TreeRow& row = rows_[i];
    // From the last row to the first: a row that follows its parent directly passes its load on in a
    // register. Otherwise the load goes to a sum in memory.
    row.sums = row.root >= 0 || row.collects;
    row.tip = i + 1 == rows_.size() || rows_[i + 1].way != TreeRow::kOn;
    if (row.parent < 0) continue;
    TreeRow& up = rows_[static_cast<std::size_t>(row.parent)];
    if (static_cast<std::size_t>(row.parent) + 1 == i) {
      row.way = TreeRow::kOn;
    } else {
      row.way = up.collects ? TreeRow::kAdd : TreeRow::kSet;
      up.collects = true;
    }
  }
}

// A node without a parent begins a part.
void Tree::find_parts() {
  part_of_.clear();
  int parts = 0;
  for (const TreeNode& node : nodes_)
    part_of_.push_back(node.parent < 0 ? parts++ : part_of_[static_cast<std::size_t>(node.parent)]);
}

}  // namespace visum::dynamics::impulse
